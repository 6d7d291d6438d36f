"""The last check before the motors: a command passes, is limited, or the cycle damps, and the reason is said."""

from __future__ import annotations

import numpy as np

from surefoot.bus.messages import JointCommand
from surefoot.config.hw import Hw
from surefoot.config.robot import JOINT_NAMES, Robot
from surefoot.hw.robot_interface import MotorLaw, damping_law


class Gate:
    """Passes finite, fresh commands inside the limits; everything else damps in the same cycle.

    When it has damped for `latch_after_s` the robot has left the posture that commands were made for: from then on
    it damps whatever comes, until the whole-body controller damps as well because the state machine tells it to.
    That is left only by a person's command, from the posture in which the robot is by then.

    Attributes:
        damping: whether the last cycle damped.
        reason: why it damped or what it limited, with value and limit; empty when nothing was amiss.
    """

    def __init__(self, robot: Robot, settings: Hw):
        self._settings = settings
        self._torque_limit = np.array(robot.per_joint("torque_limit"))
        self._velocity_limit = np.array(robot.per_joint("velocity_limit"))
        ranges = np.array(robot.position_range())
        self._lower, self._upper = ranges[:, 0], ranges[:, 1]
        self._damp = damping_law(settings.damping_kd)
        self._passed_t: float | None = None
        self._latched = ""  # by what
        self.damping = True
        self.reason = "no command yet"

    def law(self, command: JointCommand | None, t: float) -> MotorLaw:
        """The motor law of a cycle at time `t` [s]."""
        refusal = self._refusal(command, t)
        if refusal and self._passed_t is not None and t - self._passed_t >= self._settings.latch_after_s:
            self._latched = refusal
        if self._latched and not refusal and _damps_as_told(command):
            self._latched = ""
        self.damping = bool(refusal or self._latched)
        self.reason = refusal
        if self._latched:
            self.reason = f"damped too long to go on ({self._latched}): command sit, or damp, then stand"
        if command is None or self.damping:
            return self._damp
        self._passed_t = t
        return self._limited(command)

    def _refusal(self, command: JointCommand | None, t: float) -> str:
        """Why a command is not fit for the motors, in words; empty if it is."""
        if command is None:
            return "no command yet"
        if not command.valid:
            return "the whole-body controller does not vouch for its command (valid = false)"
        age = t - command.t
        if not -1e-9 <= age <= self._settings.command_timeout_s:
            limit = 1e3 * self._settings.command_timeout_s
            return f"command is {1e3 * age:.1f} ms old, limit {limit:.0f} ms: is wbc running?"
        for name in ("q", "dq", "kp", "kd", "tau"):
            values = getattr(command, name)
            if np.shape(values) != (12,):
                return f"command.{name} has shape {np.shape(values)}, expected (12,)"
            if not np.isfinite(values).all():
                joint = JOINT_NAMES[int(np.argmin(np.isfinite(values)))]
                return f"command.{name} of {joint} is not finite"
        for name, limit in (("kp", self._settings.kp_max), ("kd", self._settings.kd_max)):
            gains = getattr(command, name)
            if gains.min() < 0.0 or gains.max() > limit:
                worst = int(np.argmax(np.maximum(-gains, gains - limit)))
                return f"command.{name} of {JOINT_NAMES[worst]} = {gains[worst]:.1f}, allowed 0 to {limit:.0f}"
        return ""

    def _limited(self, command: JointCommand) -> MotorLaw:
        q = np.clip(command.q, self._lower, self._upper)
        dq = np.clip(command.dq, -self._velocity_limit, self._velocity_limit)
        tau = np.clip(command.tau, -self._torque_limit, self._torque_limit)
        for name, given, allowed, acts in (
            ("q", command.q, q, command.kp > 0.0),
            ("dq", command.dq, dq, command.kd > 0.0),
            ("tau", command.tau, tau, True),
        ):
            changed = np.abs(given - allowed) * acts
            if changed.any():
                joint = int(np.argmax(changed))
                self.reason = (
                    f"command.{name} of {JOINT_NAMES[joint]} = {given[joint]:.2f} limited to {allowed[joint]:.2f}"
                )
        return MotorLaw(q=q, dq=dq, kp=command.kp, kd=command.kd, tau=tau)


def _damps_as_told(command: JointCommand | None) -> bool:
    """Whether a command only damps, and not because the whole-body controller could not do better."""
    if command is None or command.solver != "ok":
        return False
    return not (command.kp.any() or command.dq.any() or command.tau.any())
