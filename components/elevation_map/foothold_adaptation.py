"""Visual foothold adaptation (Sec. II-A): safe footholds near the targets, and the regions around them."""

from __future__ import annotations

from collections.abc import Callable
from typing import NamedTuple

import numpy as np

from surefoot.bus.messages import FootholdRegions, FootholdRequest, Unsafe
from surefoot.components.elevation_map.foothold_heightmap import HALF, SIDE, FootholdHeightmap
from surefoot.components.elevation_map.ground_safety import GroundSafety
from surefoot.components.elevation_map.leg_safety import LegSafety
from surefoot.components.elevation_map.patch import Patch
from surefoot.components.elevation_map.safe_rectangle import SafeRectangle
from surefoot.config.elevation_map import ElevationMap
from surefoot.config.fsm import Fsm
from surefoot.config.robot import LEGS, Robot

Cut = Callable[[np.ndarray, int, int], Patch]
"""Cuts the map: of p (2,) in W [m] and half a size in cells along x and y, the patch of (2 half_x + 1) by
(2 half_y + 1) cells whose middle one is nearest to p."""


class _Foothold(NamedTuple):
    """The answer for one leg; `region` is A (4, 3) and b (4,), or None for the whole plane."""

    p_WF: np.ndarray
    reason: str
    safe: bool = True
    region: tuple[np.ndarray, np.ndarray] | None = None
    held_n: float = 0.0


class FootholdAdaptation:
    """Finds for each leg the safe cell nearest its target and the convex region around it, eq. (4).

    A foothold is a foot centre, as a target is: the centre of the foot's sphere on the plane under it.
    """

    def __init__(self, robot: Robot, settings: ElevationMap, stepping: Fsm):
        self._radius_m = robot.foot.radius
        self._settings = settings
        self._ground = GroundSafety(robot.foot.radius, settings.cell_m, settings.vfa)
        self._legs = LegSafety(robot, settings, stepping)

    def regions(self, request: FootholdRequest, cut: Cut) -> FootholdRegions:
        """The answer to a request, valid at its time.

        Args:
            request: targets, present feet and the base pose at the end of the stride.
            cut: gives a patch of the map; see `Cut`.
        """
        grounds = [
            FootholdHeightmap(cut(target[:2], *self._legs.half_cells(target, foot)))
            for target, foot in zip(request.target_WF, request.p_WF, strict=True)
        ]
        classed = [self._ground.classify(ground) for ground in grounds]
        planes = np.array([plane for _, plane in classed])
        feet_W = np.array(
            [
                self._foot_centres(ground, plane, target)
                for ground, plane, target in zip(grounds, planes, request.target_WF, strict=True)
            ]
        )
        legs = self._legs.classify(request, grounds, feet_W.reshape(len(LEGS), -1, 3))
        unsafe = np.array([flags for flags, _ in classed]) | legs.reshape(-1, SIDE, SIDE)
        footholds = [
            self._foothold(grounds[leg], unsafe[leg], planes[leg], request.target_WF[leg])
            for leg in range(len(LEGS))
        ]
        region_a, region_b = np.zeros((4, 4, 3)), np.zeros((4, 4))
        for leg, foothold in enumerate(footholds):
            if foothold.region is not None:
                region_a[leg], region_b[leg] = foothold.region
        return FootholdRegions(
            t=request.t,
            valid=True,
            id=request.id,
            foothold_WF=np.array([foothold.p_WF for foothold in footholds]),
            safe=np.array([foothold.safe for foothold in footholds]),
            region_a=region_a,
            region_b=region_b,
            region_active=np.array([foothold.region is not None for foothold in footholds]),
            held_n=np.array([foothold.held_n for foothold in footholds]),
            reasons=tuple(foothold.reason for foothold in footholds),
            cell_m=self._settings.cell_m,
            heightmap_p_W=np.array([ground.p_W for ground in grounds]),
            heightmap_m=np.array([ground.height_m for ground in grounds], np.float32),
            heightmap_unsafe=unsafe,
        )

    def _foothold(
        self, ground: FootholdHeightmap, unsafe: np.ndarray, planes: np.ndarray, target: np.ndarray
    ) -> _Foothold:
        unmapped = self._unmapped(ground)
        if unmapped:
            return _Foothold(target.copy(), unmapped)
        safe = unsafe == 0
        if not safe.any():
            return _Foothold(target.copy(), f"no safe cell of {unsafe.size}: {_counts(unsafe)}", safe=False)
        cell = _nearest(safe, ground.xy_W, target)
        stays = cell == (HALF, HALF)
        xy = target[:2] if stays else ground.xy_W[cell]
        height = _height(planes[cell], xy - ground.xy_W[cell])
        moved = np.hypot(*(xy - target[:2]))
        reason = "the target is safe"
        if not stays:
            reason = f"moved {1e2 * moved:.1f} cm: the target's cell is {_words(unsafe[HALF, HALF])}"
        return _Foothold(
            np.append(xy, height + self._above(planes[cell])),
            reason,
            region=SafeRectangle.around(safe, cell).half_spaces(ground.p_W, ground.patch.cell_m),
            held_n=self._held(ground, xy),
        )

    def _unmapped(self, ground: FootholdHeightmap) -> str:
        """Why there is no map around a target, in words; empty when there is one.

        What was seen too long ago is no map either. To call all of it unsafe would hold a robot that has rested
        for so long where it is: the camera does not see the ground under and behind it.
        """
        settings = self._settings.vfa
        missing = np.isnan(ground.height_m)
        stale = ~missing & (ground.around(ground.patch.age_s) > settings.age_max_s)
        unknown, old = int(missing.sum()), int(stale.sum())
        if unknown + old <= settings.unmapped_share * ground.height_m.size:
            return ""
        since = f", {old} seen more than {settings.age_max_s:g} s ago" if old else ""
        return f"no map there: {unknown} of {ground.height_m.size} cells unknown{since}"

    def _foot_centres(self, ground: FootholdHeightmap, planes: np.ndarray, target: np.ndarray) -> np.ndarray:
        """(15, 15, 3) foot centres over the cells [m]; at the target's height where the ground is not known."""
        z = planes[..., 0] + self._above(planes)
        return np.concatenate([ground.xy_W, np.where(np.isnan(z), target[2], z)[..., None]], axis=-1)

    def _above(self, plane: np.ndarray) -> np.ndarray:
        """(...) how far above a plane (..., 3) the centre of a sphere that lies on it is, vertically [m]."""
        return self._radius_m * np.sqrt(1.0 + plane[..., 1] ** 2 + plane[..., 2] ** 2)

    def _held(self, ground: FootholdHeightmap, xy: np.ndarray) -> float:
        """Load that all of the ground under a foot at xy (2,) is known to bear [N].

        The least over the cells whose centres the foot covers and the one that it is centred on: a load that
        held beside the foothold certifies nothing.
        """
        distance = ground.distance_m(xy)
        return float(ground.patch.held_n[distance <= max(self._radius_m, distance.min())].min())


def _nearest(safe: np.ndarray, xy_W: np.ndarray, target: np.ndarray) -> tuple[int, int]:
    """Index of the safe cell whose centre is nearest the target; of equally near ones the first by x, then y."""
    d = xy_W - target[:2]
    distance2 = np.where(safe, d[..., 0] ** 2 + d[..., 1] ** 2, np.inf)
    # Rounded to a square micrometre, or noise of the last digit would choose between equals.
    row, column = np.unravel_index(np.argmin(np.round(distance2, 12)), safe.shape)
    return int(row), int(column)


def _height(plane: np.ndarray, offset: np.ndarray) -> float:
    """Height of a plane (3,) at an offset (2,) from where it is given [m]."""
    return float(plane[0] + plane[1:] @ offset)


def _words(flags: int) -> str:
    return ", ".join(reason.name.lower() for reason in Unsafe if flags & reason and reason.name)


def _counts(unsafe: np.ndarray) -> str:
    """How many cells are unsafe for each reason, the most frequent first."""
    counts = [(int((unsafe & reason != 0).sum()), (reason.name or "").lower()) for reason in Unsafe]
    return ", ".join(f"{n} {name}" for n, name in sorted(counts, key=lambda c: -c[0]) if n)
