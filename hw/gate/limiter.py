"""Takes off a law what the robot must not be asked for."""

from __future__ import annotations

import numpy as np

from surefoot.bus.messages import JointCommand
from surefoot.config.robot import JOINT_NAMES
from surefoot.hw.gate.check import Check, Violation
from surefoot.hw.gate.limits import Limits
from surefoot.hw.robot_interface import MotorLaw, Sensors


class Limiter:
    """Holds laws to a robot's figures; what is inside them passes with the very same numbers."""

    def __init__(self, limits: Limits, torque_step: float):
        """`torque_step`: by which the torque of a joint may change from law to law [N m]."""
        self._limits, self._step = limits, torque_step

    def limited(
        self, command: JointCommand, last: MotorLaw, sensors: Sensors
    ) -> tuple[MotorLaw, tuple[Violation, ...]]:
        """A command as a law.

        First its own figures are limited, then the torque that the law makes where the joints are now, and last
        how far that is from what the motors make of the `last` law, also now: what the joints themselves have
        moved is no jump of the command. Where the step is too large the law is one between the two.

        Returns:
            The law; what had to be taken off, in the order of the table.
        """
        limits, found = self._limits, []
        law = MotorLaw(
            q=np.clip(command.q, limits.lower, limits.upper),
            dq=np.clip(command.dq, -limits.speed, limits.speed),
            kp=command.kp,
            kd=command.kd,
            tau=np.clip(command.tau, -limits.torque, limits.torque),
        )
        for check, name, gain in (
            (Check.ANGLE, "q", command.kp),
            (Check.RATE, "dq", command.kd),
            (Check.FEED_FORWARD, "tau", None),
        ):
            given, allowed = getattr(command, name), getattr(law, name)
            changed = given != allowed
            if gain is not None:
                changed &= gain > 0.0
            if changed.any():
                joint = int(np.argmax(np.abs(given - allowed) * changed))
                words = f"command.{name} of {JOINT_NAMES[joint]} = {given[joint]:.2f}"
                found.append(Violation(check, f"{words} limited to {allowed[joint]:.2f}"))
        law, torque, asked = self._within(law, sensors)
        if asked is not None:
            found.append(_cut_back(Check.TORQUE, asked, torque))
        last, before, _ = self._within(last, sensors)
        change = torque - before
        size = np.abs(change)
        if size.max() > self._step:
            share = np.minimum(1.0, self._step / np.maximum(size, self._step))
            law = self._between(last, law, share)
            found.append(_cut_back(Check.TORQUE_STEP, change, share * change))
        return law, tuple(found)

    def _within(self, law: MotorLaw, sensors: Sensors) -> tuple[MotorLaw, np.ndarray, np.ndarray | None]:
        """A law scaled down to the limits of torque; its torques; what they would have been, if they were more."""
        torque = law.tau + law.kp * (law.q - sensors.q) + law.kd * (law.dq - sensors.dq)
        size, most = np.abs(torque), self._limits.torque
        if (size <= most).all():
            return law, torque, None
        share = np.minimum(1.0, most / np.maximum(size, most))
        scaled = MotorLaw(q=law.q, dq=law.dq, kp=share * law.kp, kd=share * law.kd, tau=share * law.tau)
        return scaled, share * torque, torque

    def _between(self, last: MotorLaw, law: MotorLaw, share: np.ndarray) -> MotorLaw:
        """The law whose torque is, at any state, by `share` (12,) that of `law` and else that of `last`.

        Both pull at once, so gains and feed-forward are mixed, and references weighted by the gains.
        """

        limits = self._limits

        def mixed(a: np.ndarray, b: np.ndarray) -> np.ndarray:
            return np.where(share < 1.0, np.clip(a + share * (b - a), np.minimum(a, b), np.maximum(a, b)), b)

        def reference(a: np.ndarray, b: np.ndarray, gain_a: np.ndarray, gain_b: np.ndarray) -> np.ndarray:
            gain = mixed(gain_a, gain_b)
            weighted = np.divide(mixed(gain_a * a, gain_b * b), gain, out=b.copy(), where=gain > 0.0)
            return np.where(share < 1.0, weighted, b)

        return MotorLaw(
            q=np.clip(reference(last.q, law.q, last.kp, law.kp), limits.lower, limits.upper),
            dq=np.clip(reference(last.dq, law.dq, last.kd, law.kd), -limits.speed, limits.speed),
            kp=mixed(last.kp, law.kp),
            kd=mixed(last.kd, law.kd),
            tau=mixed(last.tau, law.tau),
        )


def _cut_back(check: Check, asked: np.ndarray, allowed: np.ndarray) -> Violation:
    joint = int(np.argmax(np.abs(asked - allowed)))
    what = {Check.TORQUE: "torque", Check.TORQUE_STEP: "step of torque"}[check]
    words = f"{what} of {JOINT_NAMES[joint]} = {asked[joint]:.1f} N m limited to {allowed[joint]:.1f} N m"
    return Violation(check, words)
