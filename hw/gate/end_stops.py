"""Joints that come near the ends of their ranges."""

from __future__ import annotations

import numpy as np

from surefoot.config.gate import Gate as Settings
from surefoot.config.robot import JOINT_NAMES, JOINTS, Robot
from surefoot.hw.gate.check import Check, Violation
from surefoot.hw.gate.limits import Limits

_CALF = JOINTS.index("calf")


class EndStops:
    """Watches each joint of a driven robot from when it has been inside its range.

    A limp robot rests on its stops: lying on the folded calves, hanging on the stretched ones. So a joint is not
    watched before it has left them, and folded calves are not while all four are, as in sitting down.
    """

    def __init__(self, robot: Robot, limits: Limits, settings: Settings):
        self._lower, self._upper = limits.lower + settings.stop_margin, limits.upper - settings.stop_margin
        self._lying = robot.nominal.lie_q[_CALF] + settings.lying
        self._watched = np.zeros(12, bool)

    def violation(self, q: np.ndarray, driven: bool) -> Violation | None:
        """What angles (12,) [rad] break, while the robot is driven or only damped."""
        low, high = q < self._lower, q > self._upper
        inside = ~(low | high)
        self._watched = self._watched | inside if driven else inside
        if not driven or inside.all():
            return None
        if (q[_CALF :: len(JOINTS)] < self._lying).all():
            low[_CALF :: len(JOINTS)] = False
        broken = (low | high) & self._watched
        if not broken.any():
            return None
        joint = int(np.argmax(broken))
        lower, upper = self._lower[joint], self._upper[joint]
        return Violation(
            Check.END_STOP,
            f"measured q of {JOINT_NAMES[joint]} = {q[joint]:.2f}, allowed {lower:.2f} to {upper:.2f}",
        )
