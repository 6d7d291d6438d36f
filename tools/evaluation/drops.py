"""How far a foothold is from where the ground drops."""

from __future__ import annotations

from itertools import pairwise

import numpy as np

from surefoot.hw.mujoco.terrain import Field

_LOOK_M = 0.20  # a drop farther away does not concern a foothold


class Drops:
    """The steps of a terrain's surface across the walk."""

    def __init__(self, field: Field, foot_radius: float):
        """Those of `field`, for feet of a radius [m]."""
        self._radius = foot_radius
        self._steps = [(x, before, after) for (x, before), (x1, after) in pairwise(field.profile) if x == x1]

    def distance(self, p_WF: np.ndarray) -> float | None:
        """Distance along x from a foot's centre (3,) to the nearest drop beside the ground on which it stands [m].

        Negative when the centre is past the drop and the foot still stands on its upper edge; None when the foot
        stands on the lower ground, or no drop is within 20 cm.
        """
        x, _, z = p_WF.tolist()
        distances = []
        for at, before, after in self._steps:
            if z - self._radius > 0.5 * (before + after) and abs(at - x) < _LOOK_M:
                distances.append(at - x if after < before else x - at)
        return min(distances, key=abs, default=None)
