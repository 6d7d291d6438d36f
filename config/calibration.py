"""Settings of `surefoot calibrate`: how long it measures, how it moves joints, and what it refuses."""

from __future__ import annotations

from dataclasses import dataclass
from math import pi
from typing import Annotated

from surefoot.config.typed_toml import ConfigError, Within

Seconds = Annotated[float, Within(0.5, 600.0)]


@dataclass(frozen=True)
class Calibration:
    """Durations, the motion of one joint at a time, and limits beyond which nothing is concluded."""

    seconds: Seconds = 10.0  # each pose is measured
    settle_s: Seconds = 40.0  # so long at the most a hung robot's legs are given to come to rest

    # Friction: each joint swings by swing_rad sin^2(pi t / swing_s) sin(2 pi swing_hz t) about the stand posture.
    swing_rad: Annotated[float, Within(0.05, 0.4)] = 0.25
    swing_hz: Annotated[float, Within(0.1, 1.0)] = 0.5
    swing_s: Annotated[float, Within(2.0, 120.0)] = 12.0
    approach_speed: Annotated[float, Within(0.05, 1.0)] = 0.4  # of the fastest joint on the way there [rad/s]
    slow_speed: Annotated[float, Within(0.01, 1.0)] = 0.1  # below it friction has no certain sign [rad/s]
    tracking_max: Annotated[float, Within(0.02, 1.0)] = 0.15  # a joint this far from where it should be [rad]
    swing_turn_max: Annotated[float, Within(0.05, 5.0)] = 0.5  # of the trunk while joints move [rad/s]

    # At rest; times are those of the measurement.
    turn_max: Annotated[float, Within(0.001, 1.0)] = 0.05  # of the trunk, mean: more is no bias [rad/s]
    drift_max: Annotated[float, Within(1e-4, 0.5)] = 0.01  # of a standing robot's joint in that time [rad]
    sink_max: Annotated[float, Within(1e-4, 0.5)] = 0.2  # of a hung robot's: a damped leg creeps on for long [rad]
    shake_max: Annotated[float, Within(0.01, 5.0)] = 0.5  # of the accelerometer, standard deviation [m/s^2]
    gravity_error_max: Annotated[float, Within(0.05, 3.0)] = 0.5  # of the accelerometer's norm [m/s^2]
    tilt_max: Annotated[float, Within(0.01, 0.5)] = 0.1  # of a standing trunk [rad]
    foot_min_n: Annotated[float, Within(1.0, 100.0)] = 20.0  # a lighter foot does not stand
    weight_error_max: Annotated[float, Within(0.01, 0.5)] = 0.15  # of what the torques say is carried, share
    hung_leg_m: Annotated[float, Within(0.05, 0.5)] = 0.25  # a damped leg this long carries nothing
    hung_torque_max: Annotated[float, Within(0.1, 20.0)] = 5.0  # of a motor that does nothing [N m]
    attitude_spread: Annotated[float, Within(0.05, 0.57)] = 0.2  # least spread of several attitudes, 0.57 the best

    def __post_init__(self) -> None:
        speed = 2.0 * pi * self.swing_hz * self.swing_rad
        if speed > 1.0:
            raise ConfigError(
                f"swing_rad = {self.swing_rad} at swing_hz = {self.swing_hz} moves a joint at {speed:.2f} rad/s: "
                "at most 1 rad/s; lower the one or the other"
            )
        if speed < 3.0 * self.slow_speed:
            raise ConfigError(
                f"swing_rad = {self.swing_rad} at swing_hz = {self.swing_hz} moves a joint at {speed:.2f} rad/s: "
                f"at least three times slow_speed = {self.slow_speed}, or too little is left to fit friction by"
            )
