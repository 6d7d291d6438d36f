"""Tells a measurement or a command from garbage."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from math import tau as full_turn
from typing import Any

import numpy as np

from surefoot.config.aliengo import Plausible
from surefoot.config.robot import JOINT_NAMES, LEGS, Robot
from surefoot.hw.aliengo.aliengo_state import AliengoState
from surefoot.hw.errors import Flaw, PacketError
from surefoot.hw.robot_interface import MotorLaw

_ANY = float(np.finfo(np.float32).max)
_AXES = ("x", "y", "z")


@dataclass(frozen=True)
class _Range:
    """Where the figures of one field lie, both limits allowed."""

    field: str
    names: Sequence[str]
    least: np.ndarray | float
    most: np.ndarray | float
    unit: str = ""
    setting: str = ""

    def refuse(self, what: str, index: int, value: float) -> PacketError:
        least, most = (float(np.broadcast_to(x, len(self.names))[index]) for x in (self.least, self.most))
        remedy = "the sender is at fault, or hw.aliengo.generation is not the robot's"
        if self.setting:
            remedy += f"; the limit is hw.aliengo.plausible.{self.setting}"
        return PacketError(
            Flaw.IMPLAUSIBLE if np.isfinite(value) else Flaw.NOT_FINITE,
            f"{what}.{self.field} of {self.names[index]}",
            f"{value:.6g} {self.unit}".rstrip(),
            f"allowed {least:.6g} to {most:.6g}",
            remedy,
        )


class _Ranges:
    """Several fields, looked at in one comparison."""

    def __init__(self, *ranges: _Range):
        self._ranges = ranges
        self._least, self._most = (
            np.concatenate([np.broadcast_to(getattr(r, end), len(r.names)) for r in ranges])
            for end in ("least", "most")
        )
        self._where = [(r, index) for r in ranges for index in range(len(r.names))]

    def check(self, what: str, source: Any) -> None:
        values = np.concatenate([np.atleast_1d(getattr(source, r.field)) for r in self._ranges])
        within = (values >= self._least) & (values <= self._most)  # false for what is not a number
        if not within.all():
            worst = int(np.argmin(within))
            field, index = self._where[worst]
            raise field.refuse(what, index, float(values[worst]))


class Plausibility:
    """The limits of one robot."""

    def __init__(self, robot: Robot, limits: Plausible):
        low, high = np.array(robot.position_range()).T
        q = _Range("q", JOINT_NAMES, low - limits.angle_margin, high + limits.angle_margin, "rad", "angle_margin")
        dq = _Range("dq", JOINT_NAMES, -limits.joint_speed, limits.joint_speed, "rad/s", "joint_speed")
        cold, hot = limits.temperature_min, limits.temperature_max
        self._some_q = high
        self._norm_error = limits.quaternion_norm_error
        self._state = _Ranges(
            q,
            dq,
            _Range("tau", JOINT_NAMES, -limits.torque, limits.torque, "N m", "torque"),
            _Range("temperature", JOINT_NAMES, cold, hot, "deg C", "temperature_min and temperature_max"),
            _Range("imu_temperature", ("the IMU",), cold, hot, "deg C", "temperature_min and temperature_max"),
            _Range(
                "omega_WB_B", _AXES, -limits.angular_velocity, limits.angular_velocity, "rad/s", "angular_velocity"
            ),
            _Range("acc_B", _AXES, -limits.acceleration, limits.acceleration, "m/s^2", "acceleration"),
            _Range("rpy", ("roll", "pitch", "yaw"), -full_turn, full_turn, "rad"),
            _Range("quat_WB", ("w", "x", "y", "z"), -2.0, 2.0),
            _Range("foot_force", LEGS, -_ANY, _ANY),
        )
        self._law = _Ranges(
            q,
            dq,
            _Range("kp", JOINT_NAMES, 0.0, _ANY, "N m/rad"),
            _Range("kd", JOINT_NAMES, 0.0, _ANY, "N m s/rad"),
            _Range("tau", JOINT_NAMES, -_ANY, _ANY, "N m"),
        )

    def check_state(self, state: AliengoState) -> None:
        """Look at every figure of a state.

        Raises:
            PacketError: one is not finite, or no robot can measure it.
        """
        self._state.check("state", state)
        norm = float(np.linalg.norm(state.quat_WB))
        if abs(norm - 1.0) > self._norm_error:
            raise PacketError(
                Flaw.IMPLAUSIBLE,
                "norm of state.quat_WB",
                f"{norm:.4g}",
                f"allowed 1 +- {self._norm_error:g} (hw.aliengo.plausible.quaternion_norm_error)",
                "the IMU does not run yet, or hw.aliengo.generation is not the robot's",
            )

    def check_law(self, law: MotorLaw) -> None:
        """Look at every figure of a motor law; angles and velocities only where their gain lets them act.

        Raises:
            PacketError: one is not finite, a gain is negative (as an integer that wrapped would be), or an angle
                or a velocity is out of any robot's range.
        """
        acting = replace(
            law,
            q=np.where((law.kp != 0.0) | ~np.isfinite(law.q), law.q, self._some_q),
            dq=np.where((law.kd != 0.0) | ~np.isfinite(law.dq), law.dq, 0.0),
        )
        self._law.check("law", acting)
