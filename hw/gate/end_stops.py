"""Joints that read beyond the ends of their ranges."""

from __future__ import annotations

import numpy as np

from surefoot.config.gate import Gate as Settings
from surefoot.config.robot import JOINT_NAMES
from surefoot.hw.gate.check import Check, Violation
from surefoot.hw.gate.limits import Limits


class EndStops:
    """Watches for angles that no joint can have: its encoder, or its offset, is wrong.

    A joint may be at its stop. A limp robot rests there, and a leg that is drawn out behind a stride, or follows
    ground that gives way, straightens up to it: who damps a robot that stands on such a leg drops it.
    """

    def __init__(self, limits: Limits, settings: Settings):
        self._lower, self._upper = limits.lower - settings.beyond_stop, limits.upper + settings.beyond_stop

    def violation(self, q: np.ndarray, driven: bool) -> Violation | None:
        """What angles (12,) [rad] break, while the robot is driven; damping does not trust them."""
        broken = (q < self._lower) | (q > self._upper)
        if not driven or not broken.any():
            return None
        joint = int(np.argmax(broken))
        lower, upper = self._lower[joint], self._upper[joint]
        return Violation(
            Check.END_STOP,
            f"measured q of {JOINT_NAMES[joint]} = {q[joint]:.2f}, allowed {lower:.2f} to {upper:.2f}",
        )
