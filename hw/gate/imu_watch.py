"""Whether the IMU still measures."""

from __future__ import annotations

import numpy as np

from surefoot.hw.gate.check import Check, Violation
from surefoot.hw.robot_interface import Sensors


class ImuWatch:
    """Noise alone moves the figures of an IMU that lives: where none of the six changes it is stuck."""

    def __init__(self, stuck_cycles: int):
        """Stuck after more than so many cycles without a change."""
        self._most = stuck_cycles
        self._figures = np.zeros(6)
        self._unchanged = 0

    def violation(self, sensors: Sensors, driven: bool) -> Violation | None:
        """Look at a cycle's reading. What is not driven may lie as still as a simulated robot does."""
        figures = np.concatenate([sensors.omega_WB_B, sensors.acc_B])
        still = driven and bool((figures == self._figures).all())
        self._unchanged = self._unchanged + 1 if still else 0
        self._figures = figures
        if self._unchanged <= self._most:
            return None
        found = f"gyroscope and accelerometer have not changed for {self._unchanged} cycles, limit {self._most}"
        return Violation(Check.IMU, found)
