"""The press test's verdict on a point, and how sure it is there."""

from __future__ import annotations

from functools import lru_cache

import numpy as np

from surefoot.config.deployment import Deployment
from surefoot.hw.mujoco.press_test import PressTest

NEAR_M = 0.005
"""A foot that rolls and slips stands as near to where the press test presses; on a joint between two tiles that
decides whether one bears it or both."""

NEAR_SHARE = 0.03
"""As near to the asked force a probe presses (docs/evaluation.md)."""

_AROUND = [(0.0, 0.0), *((NEAR_M * np.cos(a), NEAR_M * np.sin(a)) for a in np.arange(8) * 0.25 * np.pi)]


class Labels:
    """The truth that probes are graded with, to the millimetre and the newton."""

    def __init__(self, deployment: Deployment):
        """For a deployment's terrain as it is at the start of a run."""
        self._press = lru_cache(maxsize=None)(PressTest(deployment).press)

    def fails(self, point: np.ndarray, force_n: float) -> bool:
        """Whether the ground gives way at a point (2,) under that force [N]."""
        x, y = point.tolist()
        return self._press(round(x, 3), round(y, 3), round(force_n)).collapsible

    def in_doubt(self, point: np.ndarray, force_n: float) -> bool:
        """Whether the verdict is another one within `NEAR_M` of the point, or `NEAR_SHARE` of the force."""
        verdict = self.fails(point, force_n)
        forces = (force_n * (1.0 - NEAR_SHARE), force_n * (1.0 + NEAR_SHARE))
        if any(self.fails(point, force) != verdict for force in forces):
            return True
        return any(self.fails(point + offset, force_n) != verdict for offset in _AROUND)
