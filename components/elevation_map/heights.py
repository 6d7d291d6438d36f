"""The heights of the cells: one filter for each, what it doubts, and what it forgets."""

from __future__ import annotations

import numpy as np

from surefoot.components.elevation_map.depth_points import Points, View
from surefoot.components.elevation_map.torus import Torus
from surefoot.config.elevation_map import ElevationMap


class Heights:
    """Layers `height` [m], `variance` [m^2], `seen_t` [s] of a torus; NaN where nothing is known.

    A cell is a scalar Kalman filter: P. Fankhauser et al., "Probabilistic terrain mapping for mobile robots with
    uncertain localization", RA-L 2018. A height far off is doubted first, and taken over if it stays.
    """

    def __init__(self, settings: ElevationMap, torus: Torus):
        self._settings, self._torus = settings, torus
        self._height, self._variance, self._seen_t = (
            torus.add(name, np.nan) for name in ("height", "variance", "seen_t")
        )
        self._doubted = torus.add("doubted", np.nan)
        self._doubts, self._passed = (torus.add(name, 0, np.uint8) for name in ("doubts", "passed"))

    def grow(self, added_m2: float) -> None:
        """The base has moved: what was seen before is known less well."""
        self._variance += added_m2

    def shift(self, by_m: float) -> None:
        """Move every height up."""
        self._height += by_m
        self._doubted += by_m

    def fuse(self, points: Points, t: float) -> None:
        """Take one image's points in.

        Ground far below a known height may lie under it, seen from the side; `see_through` tells whether the
        height is still there.
        """
        settings = self._settings
        height, variance = self._height.reshape(-1), self._variance.reshape(-1)
        cells, measured, noise = self._measure(points)
        on_top = ~(measured < height[cells] - 2.0 * settings.clearance_m)
        cells, measured, noise = cells[on_top], measured[on_top], noise[on_top]
        doubts, doubted = self._doubts.reshape(-1), self._doubted.reshape(-1)
        old, old_variance = height[cells], variance[cells]
        new = np.isnan(old)
        off = (measured - old) ** 2 > settings.gate * (old_variance + noise)
        gain = old_variance / (old_variance + noise)
        count = np.where(off, np.minimum(doubts[cells], 254) + 1, 0)
        change = off & (count >= settings.takeover_frames)
        # A surface that still moves is as uncertain as its last two heights are apart.
        unrest = np.where(change & (count > 1), (measured - doubted[cells]) ** 2, 0.0)
        fresh, kept = new | change, off & ~change
        height[cells] = np.where(fresh, measured, np.where(kept, old, old + gain * (measured - old)))
        variance[cells] = np.where(
            fresh, noise + unrest, np.where(kept, old_variance, (1.0 - gain) * old_variance)
        )
        variance[cells] = np.maximum(variance[cells], settings.std_floor_m**2)
        doubts[cells] = np.where(kept, count, 0)
        doubted[cells] = np.where(kept, measured, np.nan)
        self._seen_t.reshape(-1)[cells] = t
        self._passed.reshape(-1)[cells] = 0

    def see_through(self, view: View, t: float) -> None:
        """Forget heights that rays pass well below, frame after frame: something that is no longer there.

        Each known cell that this image has not measured is looked for in it, a clearance lower than its height:
        a pixel that sees farther than that sees through it.
        """
        settings, torus = self._settings, self._torus
        height, passed = self._height.reshape(-1), self._passed.reshape(-1)
        cells = np.flatnonzero(~np.isnan(height) & (self._seen_t.reshape(-1) != t))
        p_W = np.column_stack([torus.places(torus.stored(cells)), height[cells] - settings.clearance_m])
        seen, own = view.depth_at(p_W)
        noise = settings.range_noise_m * seen * seen
        through = seen > own + 2.0 * torus.cell_m + 3.0 * noise
        # Where the image tells nothing, what it told before stands.
        passed[cells] = np.where(
            through, np.minimum(passed[cells], 254) + 1, np.where(seen > 0.0, 0, passed[cells])
        )
        gone = cells[passed[cells] >= settings.takeover_frames]
        for layer in (height, self._variance.reshape(-1), self._seen_t.reshape(-1), self._doubted.reshape(-1)):
            layer[gone] = np.nan
        passed[gone] = self._doubts.reshape(-1)[gone] = 0

    def _measure(self, points: Points) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
        """What an image says of each cell it sees: where it is stored (flat), height [m] and variance [m^2].

        Of several surfaces in one cell, above a vertical face, the uppermost counts: a foot stands on it.
        """
        inside, at = self._torus.find(self._torus.cells(points.p_W[:, :2]))
        if not len(at):
            return at, np.zeros(0), np.zeros(0)
        order = np.argsort(at)
        at, z = at[order], points.p_W[inside, 2][order]
        begin = np.flatnonzero(np.diff(at, prepend=-1))
        group = np.repeat(np.arange(len(begin)), np.diff(begin, append=len(at)))
        upper = z > np.maximum.reduceat(z, begin)[group] - self._settings.surface_m
        floor = self._settings.std_min_m**2
        weight = upper / (points.noise_m2[inside][order] + floor)
        total = np.add.reduceat(weight, begin)
        mean = np.add.reduceat(weight * z, begin) / total
        # What many points of one image share, tilt and the cell's own unevenness, does not average out.
        tilt = np.add.reduceat(weight * points.tilt_m2[inside][order], begin) / total
        return at[begin], mean, 1.0 / total + tilt + floor
