"""The power that the motors turn over, by the rule of the vendor's own protection."""

from __future__ import annotations

import numpy as np

from surefoot.hw.gate.check import Check, Violation

_MOST, _TOLERATED = 10, 5


class PowerWatch:
    """Counts cycles above the limit up, others down, between 0 and 10; above 5 it is too much.

    The vendor counts twelve motors in some versions and one beside them in others, and ends the program without a
    last command; here it is all twelve, and the gate damps.
    """

    def __init__(self, limit: float):
        """`limit`: of the sum of all motors, whatever the direction [W]."""
        self._limit = limit
        self._over = 0

    def violation(self, tau: np.ndarray, dq: np.ndarray) -> Violation | None:
        """Count a cycle with torques [N m] and speeds [rad/s] as measured, (12,) each."""
        power = float(np.abs(tau) @ np.abs(dq))
        self._over = min(self._over + 1, _MOST) if power > self._limit else max(self._over - 1, 0)
        if self._over <= _TOLERATED:
            return None
        return Violation(Check.POWER, f"power is {power:.0f} W, limit {self._limit:.0f} W for {_TOLERATED} cycles")
