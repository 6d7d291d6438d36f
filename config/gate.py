"""Settings of the safety gate: how much of what the robot can do may be asked of it, and when it damps.

What an ordinary walk reaches stands in brackets: the most seen in 24 s over planks, one that breaks included.
Angles, speeds and torques of single joints are the robot's own figures, in `config/robots/`; ages of commands and
gains are settings of `hw`.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Annotated

from surefoot.config.typed_toml import Within, ordered

Celsius = Annotated[float, Within(0.0, 120.0)]


@dataclass(frozen=True)
class Gate:
    """Each limit itself is allowed; what is beyond it is answered as the table in `hw/gate/check.py` says."""

    # Of the robot's torques, feed-forward and in all (69 % of a calf's); lower it for a robot's first steps.
    torque_share: Annotated[float, Within(0.05, 1.0)] = 1.0
    # By which a law may change a joint's torque from cycle to cycle [N m] (24); a full reversal is 71 to 89.
    torque_step: Annotated[float, Within(0.5, 200.0)] = 50.0
    # Of the robot's joint speeds, as measured: 16 rad/s, calves 12.7 (4.3). Commands may use all of it.
    speed_share: Annotated[float, Within(0.05, 2.0)] = 0.8
    # Of all motors [W] (95); half of what the vendor's own protection allows at its highest level.
    power: Annotated[float, Within(10.0, 2000.0)] = 500.0
    # Of a measured angle beyond the end of its range [rad] (none: a leg behind a stride comes within 0.04 of it).
    # The vendor's own protection ends the program 0.087 before the end, and with it this walk in mid-stride.
    beyond_stop: Annotated[float, Within(0.0, 0.5)] = 0.087
    # Of a motor [deg C]; an emulated one ends there by a steady 30 N m.
    temperature_warn: Celsius = 70.0
    # [deg C]; 10 below where an emulated motor brakes by itself. The vendor gives no figure.
    temperature_max: Celsius = 80.0
    # Of the trunk from upright [rad] (0.07); roll and pitch of 0.7 each, at which fsm damps first, make 0.95.
    tilt_max: Annotated[float, Within(0.1, 3.2)] = 1.0
    # For so long the gate's attitude follows the gyroscope more than the accelerometer [s].
    tilt_filter_s: Annotated[float, Within(0.05, 10.0)] = 0.5
    # Without a change of any figure of the IMU (2): 0.1 s; noise alone moves them.
    imu_stuck_cycles: Annotated[int, Within(5, 5000)] = 50
    # Without a change of a joint's angle (1), while its law or its leg moves by more than `encoder_moved`: 0.05 s.
    encoder_stuck_cycles: Annotated[int, Within(5, 5000)] = 25
    encoder_moved: Annotated[float, Within(0.005, 1.0)] = 0.05  # [rad]
    # A motor may be off what is asked of it by a figure [N m] and a share (2.4 in all, half of it for 1 cycle).
    motor_torque_off: Annotated[float, Within(1.0, 100.0)] = 4.0
    motor_torque_share: Annotated[float, Within(0.0, 1.0)] = 0.3
    motor_off_cycles: Annotated[int, Within(5, 5000)] = 25  # by more for so long (0): 0.05 s
    # By the angle error of the first law after damping [N m] (1.3); 0.12 rad at the posture's gain.
    first_torque: Annotated[float, Within(0.5, 500.0)] = 30.0
    # Older measurements hold the last law [s]; the link's own limit, a fault, is 0.05.
    state_timeout_s: Annotated[float, Within(0.004, 1.0)] = 0.030
    # A law is held for so long at the most, then the gate damps [s].
    hold_s: Annotated[float, Within(0.0, 0.2)] = 0.020

    def __post_init__(self) -> None:
        ordered(self, "temperature_warn", "temperature_max", "the warning comes first")
