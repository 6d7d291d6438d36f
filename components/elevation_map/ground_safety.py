"""What is wrong with the ground under a foot, cell by cell."""

from __future__ import annotations

from math import tan

import numpy as np

from surefoot.bus.messages import Unsafe
from surefoot.components.elevation_map.foot_disc import FootDisc
from surefoot.components.elevation_map.foothold_heightmap import FootholdHeightmap
from surefoot.config.elevation_map import Vfa


class GroundSafety:
    """Classes the cells of a heightmap by the ground alone: all of `Unsafe` but LEG and REACH.

    Attributes:
        border: cells that are looked at beyond the heightmap.
    """

    def __init__(self, foot_radius_m: float, cell_m: float, settings: Vfa):
        self._settings = settings
        self._disc = FootDisc(foot_radius_m + settings.disc_margin_m, cell_m)
        self.border = self._disc.half
        offsets = cell_m * (np.argwhere(self._disc.inside) - self._disc.half)
        self._columns = np.column_stack([np.ones(len(offsets)), offsets])  # of the plane c + gx x + gy y
        # As far as this apart the steepest slope that is allowed is no step yet; farther, a ramp would be an edge.
        apart = int(settings.edge_max_m / tan(settings.slope_max) / cell_m)
        self._apart = range(1, min(max(apart, 1), 2 * self.border) + 1)

    def classify(self, ground: FootholdHeightmap) -> tuple[np.ndarray, np.ndarray]:
        """Flags of `Unsafe` (15, 15), and the planes (15, 15, 3) under a foot on each cell.

        A plane is the height [m] at the cell's centre and the slopes along x and y; NaN where too little of the
        ground is known to tell.
        """
        settings, patch = self._settings, ground.patch
        height = ground.around(patch.height_m, self.border)
        std, age = ground.around(patch.std_m, self.border), ground.around(patch.age_s, self.border)
        unknown = np.isnan(height)
        certain = (std <= settings.std_max_m) & (age <= settings.age_max_s)
        lacking = self._lacking(unknown)
        planes, error = self._planes(height, ~lacking)
        slope = np.hypot(planes[..., 1], planes[..., 2])
        collapsed = self._disc.cells(ground.around(patch.collapsed_n, self.border)) > 0.0
        flags = np.zeros(lacking.shape, np.int64)
        for reason, there in (
            (Unsafe.UNKNOWN, lacking),
            (Unsafe.UNCERTAIN, self._lacking(~certain & ~unknown)),
            (Unsafe.ROUGH, error > settings.plane_error_max_m),
            (Unsafe.STEEP, slope > tan(settings.slope_max)),
            (Unsafe.EDGE, self._edge(height)),
            (Unsafe.COLLAPSED, collapsed.any(axis=-1)),
        ):
            flags[there] |= reason
        return flags, planes

    def _lacking(self, missing: np.ndarray) -> np.ndarray:
        """(15, 15) whether the cell itself is missing, or too many are under a foot that stands there."""
        share = self._disc.cells(missing).mean(axis=-1)
        inner = slice(self.border, -self.border)
        return missing[inner, inner] | (share > self._settings.disc_gaps_max)

    def _planes(self, height: np.ndarray, told: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """Least-squares planes (15, 15, 3) under the foot, and the farthest cell from each (15, 15) [m]."""
        under = self._disc.cells(height)[told]
        known = ~np.isnan(under)
        level = np.where(known, under, 0.0)
        base = level.mean(axis=1, keepdims=True)  # keeps the squares of a high ground's heights out of the sums
        level = np.where(known, level - base, 0.0)
        C = self._columns
        products = C[:, :, None] * C[:, None, :]
        normal = (known @ products.reshape(len(C), 9)).reshape(-1, 3, 3)
        fitted = np.linalg.solve(normal, (level @ C)[..., None])[..., 0]
        off = np.where(known, np.abs(level - fitted @ C.T), 0.0)
        planes, error = np.full((*told.shape, 3), np.nan), np.full(told.shape, np.nan)
        fitted[:, :1] += base
        planes[told], error[told] = fitted, off.max(axis=1)
        return planes, error

    def _edge(self, height: np.ndarray) -> np.ndarray:
        """(15, 15) whether cells close to each other along x or y, both under the foot, differ in height."""
        windows = np.where(self._disc.inside, self._disc.windows(height), np.nan)
        edge = np.zeros(windows.shape[:2], bool)
        for k in self._apart:
            for ahead, behind in (
                (windows[..., k:, :], windows[..., :-k, :]),
                (windows[..., k:], windows[..., :-k]),
            ):
                edge |= (np.abs(ahead - behind) > self._settings.edge_max_m).any(axis=(2, 3))
        return edge
