"""Whether a command is fit for the motors."""

from __future__ import annotations

import numpy as np

from surefoot.bus.messages import JointCommand
from surefoot.config.hw import Hw
from surefoot.config.robot import JOINT_NAMES
from surefoot.hw.gate.check import Check, Violation
from surefoot.hw.gate.limits import Limits
from surefoot.hw.robot_interface import MotorLaw

_FIELDS = ("q", "dq", "kp", "kd", "tau")


class CommandWatch:
    """Looks at one command at a time; remembers none."""

    def __init__(self, limits: Limits, settings: Hw):
        self._limits, self._settings = limits, settings

    def violation(self, command: JointCommand | None, t: float) -> Violation | None:
        """What makes a command unfit at time `t` [s], whatever the robot does."""
        if command is None:
            return Violation(Check.ABSENT, "no command yet")
        if not command.valid:
            return Violation(
                Check.INVALID, "the whole-body controller does not vouch for its command (valid = false)"
            )
        age, limit = t - command.t, self._settings.command_timeout_s
        if not -1e-9 <= age <= limit:
            return Violation(Check.OLD, f"command is {1e3 * age:.1f} ms old, limit {1e3 * limit:.0f} ms")
        return self._malformed(command) or self._gains(command)

    def first(self, command: JointCommand, q: np.ndarray) -> Violation | None:
        """Whether a command's angles are too far from where the joints lie, (12,) [rad]."""
        limits, most = self._limits, self._settings.gate.first_torque
        pull = command.kp * np.abs(np.clip(command.q, limits.lower, limits.upper) - q)
        if pull.max() <= most:
            return None
        joint = int(np.argmax(pull))
        return Violation(
            Check.FIRST,
            f"first command.q of {JOINT_NAMES[joint]} = {command.q[joint]:.2f} pulls it from {q[joint]:.2f} with "
            f"{pull[joint]:.1f} N m, limit {most:.1f} N m",
        )

    def _malformed(self, command: JointCommand) -> Violation | None:
        for name in _FIELDS:
            if np.shape(getattr(command, name)) != (12,):
                shape = np.shape(getattr(command, name))
                return Violation(Check.SHAPE, f"command.{name} has shape {shape}, expected (12,)")
        finite = np.isfinite([getattr(command, name) for name in _FIELDS])
        if finite.all():
            return None
        row, joint = np.argwhere(~finite)[0]
        return Violation(Check.NOT_FINITE, f"command.{_FIELDS[row]} of {JOINT_NAMES[joint]} is not finite")

    def _gains(self, command: JointCommand) -> Violation | None:
        for name, limit in (("kp", self._settings.kp_max), ("kd", self._settings.kd_max)):
            gains = getattr(command, name)
            if gains.min() < 0.0 or gains.max() > limit:
                worst = int(np.argmax(np.maximum(-gains, gains - limit)))
                return Violation(
                    Check.GAINS,
                    f"command.{name} of {JOINT_NAMES[worst]} = {gains[worst]:.1f}, allowed 0 to {limit:.0f}",
                )
        return None


def drives(law: JointCommand | MotorLaw) -> bool:
    """Whether a law does more than brake."""
    return bool(law.kp.any() or law.dq.any() or law.tau.any())


def damps_as_told(command: JointCommand | None) -> bool:
    """Whether a command only damps, and not because the whole-body controller could not do better."""
    return command is not None and command.solver == "ok" and not drives(command)
