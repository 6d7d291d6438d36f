"""From policy to joint torques: virtual impedance on the wrench at the centre of mass, as a QP."""
