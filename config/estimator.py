"""Settings of the state estimator."""

from __future__ import annotations

from dataclasses import dataclass


@dataclass(frozen=True)
class Estimator:
    """Noise figures and thresholds of the contact-aided filter."""

    start_x_m: float = 0.0  # where the run's world puts the robot at the start
    start_y_m: float = 0.0

    # Standard deviations; "rate" figures are random walks per square root of a second.
    acc: float = 0.1  # white, per sample: sensor noise and what the integration misses [m/s^2]
    gyro: float = 0.01  # white, per sample [rad/s]
    acc_bias_rate: float = 0.002  # [m/s^2/sqrt(s)]
    gyro_bias_rate: float = 0.0002  # [rad/s/sqrt(s)]
    acc_bias_start: float = 0.05  # [m/s^2]
    gyro_bias_start: float = 0.01  # [rad/s]
    tilt_start: float = 0.02  # from one accelerometer reading [rad]
    encoder: float = 0.001  # [rad]
    kinematics: float = 0.001  # foot roll and deflection [m]
    stance_rate: float = 0.003  # a foot on trusted ground creeps [m/sqrt(s)]
    probing_rate: float = 0.2  # a foot on ground that is not trusted [m/sqrt(s)]
    slip_gate: float = 20.0  # squared Mahalanobis distance beyond which a foot is taken to slip
    position_limit: float = 1.0  # standard deviation of height or tilt that means divergence [m, rad]

    # Contact by eq. (7).
    force_filter_hz: float = 30.0  # low-pass of the estimated force
    contact_on_n: float = 10.0  # above an airborne foot's estimate, below the lightest stance foot
    contact_off_n: float = 6.0
    contact_hits: int = 3  # successive positives (Sec. II-D.4)
    contact_every: int = 2  # filter cycles between two looks: 250 Hz
    friction_speed: float = 0.1  # joint speed over which Coulomb friction turns round [rad/s]

    normal_filter: float = 0.025  # share of a new plane fit taken in each cycle
    normal_tilt_max: float = 0.35  # [rad]
