"""Settings of the state estimator."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Annotated

from surefoot.config.quantities import FrictionSpeed, Share
from surefoot.config.typed_toml import ConfigError, Within, ordered

Place = Annotated[float, Within(-1e3, 1e3)]
White = Annotated[float, Within(1e-5, 10.0)]  # without noise of its own the prediction would ignore the feet
Walk = Annotated[float, Within(0.0, 10.0)]
Start = Annotated[float, Within(0.0, 5.0)]
Kinematic = Annotated[float, Within(1e-6, 0.1)]  # above 0: the slip test divides by it
Limit = Annotated[float, Within(0.01, 100.0)]
SlipGate = Annotated[float, Within(1.0, 1e6)]
Force = Annotated[float, Within(0.0, 200.0)]


@dataclass(frozen=True)
class Estimator:
    """Noise figures and thresholds of the contact-aided filter."""

    start_x_m: Place = 0.0  # where the run's world puts the robot at the start
    start_y_m: Place = 0.0

    # Standard deviations; "rate" figures are random walks per square root of a second.
    acc: White = 0.1  # white, per sample: sensor noise and what the integration misses [m/s^2]
    gyro: White = 0.01  # white, per sample [rad/s]
    acc_bias_rate: Walk = 0.002  # [m/s^2/sqrt(s)]
    gyro_bias_rate: Walk = 0.0002  # [rad/s/sqrt(s)]
    acc_bias_start: Start = 0.05  # [m/s^2]
    gyro_bias_start: Start = 0.01  # [rad/s]
    tilt_start: Annotated[float, Within(0.0, 0.5)] = 0.02  # from one accelerometer reading [rad]
    encoder: Kinematic = 0.001  # [rad]
    kinematics: Kinematic = 0.001  # foot roll and deflection [m]
    stance_rate: Walk = 0.003  # a foot on trusted ground creeps [m/sqrt(s)]
    probing_rate: Walk = 0.2  # a foot on ground that is not trusted [m/sqrt(s)]
    rest_speed: White = 0.02  # of a trunk that lies still [m/s] ...
    rest_rate: Annotated[float, Within(0.01, 1.0)] = 0.1  # ... and turns slower than this [rad/s]
    slip_gate: SlipGate = 20.0  # squared Mahalanobis distance beyond which a foot is taken to slip
    position_limit: Limit = 1.0  # standard deviation of height or tilt that means divergence [m, rad]

    # Contact by eq. (7).
    force_filter_hz: Annotated[float, Within(0.5, 250.0)] = 30.0  # low-pass of the estimated force
    contact_on_n: Force = 10.0  # above an airborne foot's estimate, below the lightest stance foot
    contact_off_n: Force = 6.0
    contact_hits: Annotated[int, Within(1, 50)] = 3  # successive positives (Sec. II-D.4)
    contact_every: Annotated[int, Within(1, 50)] = 2  # filter cycles between two looks: 250 Hz
    friction_speed: FrictionSpeed = 0.1  # joint speed over which Coulomb friction turns round [rad/s]

    normal_filter: Share = 0.025  # share of a new plane fit taken in each cycle
    normal_tilt_max: Annotated[float, Within(0.0, 1.2)] = 0.35  # [rad]

    def __post_init__(self) -> None:
        ordered(self, "stance_rate", "probing_rate", "ground that is not trusted cannot hold a foot better")
        ordered(self, "contact_off_n", "contact_on_n", "a contact must not end at a force that would begin it")
        if self.tilt_start >= self.position_limit:
            raise ConfigError(
                f"tilt_start = {self.tilt_start} reaches position_limit = {self.position_limit}: "
                "the filter would call itself diverged from the start; lower the one or raise the other"
            )
