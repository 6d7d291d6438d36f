"""An Aliengo that is not there: MuJoCo's robot behind the real packets, and what may go wrong on their way."""
