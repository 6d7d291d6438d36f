"""The foothold heightmap of one leg: 15x15 cells around its target, and the map around them (Fig. 3)."""

from __future__ import annotations

import numpy as np

from surefoot.components.elevation_map.patch import Patch

HALF = 7
SIDE = 2 * HALF + 1


class FootholdHeightmap:
    """The middle of a patch, whose cells a foot may be sent to; the rest is what it meets on the way.

    Attributes:
        patch: the map around the target; its middle cell is the one nearest to the target.
        p_W: (2,) x, y of the centre of the heightmap's cell [0, 0] [m].
        xy_W: (15, 15, 2) centres of its cells [m].
        height_m: (15, 15) heights [m]; NaN unknown.
    """

    def __init__(self, patch: Patch):
        self.patch = patch
        n, m = patch.height_m.shape
        self._first = ((n - SIDE) // 2, (m - SIDE) // 2)
        self.p_W = patch.p_W + patch.cell_m * np.array(self._first)
        steps = patch.cell_m * np.arange(SIDE)
        self.xy_W = np.empty((SIDE, SIDE, 2))
        self.xy_W[..., 0] = (self.p_W[0] + steps)[:, None]
        self.xy_W[..., 1] = self.p_W[1] + steps
        self.height_m = self.around(patch.height_m)

    def around(self, values: np.ndarray, border: int = 0) -> np.ndarray:
        """(15 + 2 border, 15 + 2 border) of the patch's values: the heightmap's, and a border's around it."""
        i, j = self._first[0] - border, self._first[1] - border
        return values[i : i + SIDE + 2 * border, j : j + SIDE + 2 * border]

    def distance_m(self, xy_W: np.ndarray) -> np.ndarray:
        """(n, m) horizontal distance of the patch's cell centres from a point (2,) [m]."""
        dx, dy = (
            self.patch.p_W[axis] + self.patch.cell_m * np.arange(count) - xy_W[axis]
            for axis, count in enumerate(self.patch.height_m.shape)
        )
        return np.hypot(dx[:, None], dy)

    def at(self, values: np.ndarray, p_W: np.ndarray, outside: float) -> np.ndarray:
        """(...) a quantity of the patch at points (..., 2 or 3) in W; `outside` beyond it."""
        n, m = values.shape
        # Half a cell is added and cut off: cheaper than rounding, and as good off the border.
        scale = 1.0 / self.patch.cell_m
        i = np.floor((p_W[..., 0] - self.patch.p_W[0]) * scale + 0.5).astype(np.intp)
        j = np.floor((p_W[..., 1] - self.patch.p_W[1]) * scale + 0.5).astype(np.intp)
        there = (i >= 0) & (i < n) & (j >= 0) & (j < m)
        return np.where(there, values[np.where(there, i, 0), np.where(there, j, 0)], outside)
