"""What of the robot is broken or done to it, and when."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from surefoot.config.emulator import Fault
from surefoot.config.robot import JOINT_NAMES

_PUSHES = {"tipped over": (0.0, 0.0, 0.0, 45.0, 0.0, 0.0), "blow": (0.0, 0.0, -1500.0, 0.0, 0.0, 0.0)}
"""Force [N] and moment [N m] on the trunk, in the world: in 0.6 s and 0.04 s they do what they are called."""


class BrokenParts:
    """Asked by kind and the robot's time."""

    def __init__(self, faults: Sequence[Fault]):
        self._faults = tuple(faults)

    def has(self, kind: str, t: float) -> bool:
        """Whether something of this kind is broken at time `t` [s]."""
        return bool(self._of(kind, t))

    def joints(self, kind: str, t: float) -> np.ndarray:
        """(12,) bool: the joints that it is of."""
        broken = {fault.joint for fault in self._of(kind, t)}
        return np.array([name in broken for name in JOINT_NAMES])

    def push(self, t: float) -> np.ndarray:
        """(6,) force [N] and moment [N m] on the trunk, in the world."""
        return sum((np.array(push) for kind, push in _PUSHES.items() if self._of(kind, t)), np.zeros(6))

    def _of(self, kind: str, t: float) -> list[Fault]:
        return [fault for fault in self._faults if fault.kind == kind and fault.begin_s <= t < fault.end_s]
