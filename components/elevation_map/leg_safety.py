"""Whether legs can go to cells without meeting the ground, and reach them."""

from __future__ import annotations

from math import ceil

import numpy as np

from surefoot.bus.messages import FootholdRequest, Unsafe
from surefoot.components.elevation_map.foothold_heightmap import HALF, FootholdHeightmap
from surefoot.components.elevation_map.rolling_ball import RollingBall
from surefoot.components.elevation_map.swing_path import SwingPath
from surefoot.components.robot_model import LegKinematics
from surefoot.components.robot_model.rotation import matrix_of_rpy
from surefoot.config.elevation_map import ElevationMap
from surefoot.config.fsm import Fsm
from surefoot.config.robot import Primitive, Robot


class LegSafety:
    """LEG and REACH of `Unsafe`, for cells of all four legs at once.

    Foot, calf and thigh are balls and capsules; the clearance is added to their radii. Ground that is not known
    is met by nothing.
    """

    def __init__(self, robot: Robot, settings: ElevationMap, stepping: Fsm):
        clearance, cell_m = settings.vfa.clearance_m, settings.cell_m
        self._legs = LegKinematics(robot)
        self._swing = SwingPath(stepping)
        self._reach_m = stepping.leg_length_max_m
        self._radius_m = robot.foot.radius
        self._foot, self._calf, self._thigh = (
            RollingBall(radius + clearance, cell_m)
            for radius in (robot.foot.radius, *(_radius(robot.collision[part]) for part in ("calf", "thigh")))
        )
        # From a foot's diameter up; what is nearer to the foot is under its disc, which EDGE and ROUGH judge.
        self._calf_shares = _shares(2.0 * robot.foot.radius / robot.calf_length, robot.calf_length / cell_m)
        self._thigh_shares = _shares(0.0, robot.thigh_length / cell_m)
        self._cell_m = cell_m
        self._beyond_m = robot.calf_length  # of a cell, where its calf and most of its thigh are
        self._farthest_m = 2.0 * robot.reach

    def half_cells(self, target_W: np.ndarray, p_WF: np.ndarray) -> tuple[int, int]:
        """Cells to each side of the target, along x and y, where a leg on its way to the heightmap may be.

        A foot that is farther away than two legs' length cannot be on its way.
        """
        border = HALF + self._foot.half + 1
        halves = []
        for way in np.minimum(np.abs(target_W[:2] - p_WF[:2]), self._farthest_m):
            halves.append(border + ceil(max(float(way), self._beyond_m) / self._cell_m))
        return halves[0], halves[1]

    def classify(
        self, request: FootholdRequest, grounds: list[FootholdHeightmap], feet_W: np.ndarray
    ) -> np.ndarray:
        """(4, n) flags of feet that stand at (4, n, 3) foot centres in W under the target base pose."""
        p_WB, R_WB = request.base_target[:3], matrix_of_rpy(request.base_target[3:])
        feet_B = ((feet_W - p_WB) @ R_WB).swapaxes(0, 1)
        q, solved = self._legs.inverse(feet_B)
        thighs, knees = (points.swapaxes(0, 1) @ R_WB.T + p_WB for points in self._legs.joints(q))
        far = ~solved | (self._legs.length(feet_B) > self._reach_m)
        flags = np.where(far.T, Unsafe.REACH, 0).astype(np.int64)
        for leg, ground in enumerate(grounds):
            foot, knee, thigh = feet_W[leg], knees[leg], thighs[leg]
            height = ground.patch.height_m
            meets = self._meets_on_the_way(ground, request.p_WF[leg], foot, request.normal_W)
            meets |= _meets(ground, self._calf.lowest_centre(height), _between(foot, knee, self._calf_shares))
            meets |= _meets(ground, self._thigh.lowest_centre(height), _between(knee, thigh, self._thigh_shares))
            flags[leg, meets] |= Unsafe.LEG
        return flags

    def _meets_on_the_way(
        self, ground: FootholdHeightmap, p_from: np.ndarray, p_to: np.ndarray, normal_W: np.ndarray
    ) -> np.ndarray:
        """(n,) whether the foot meets the ground between where it stands and each of p_to (n, 3).

        Within a foot's radius of either end it goes up or down where it stood or will stand: that is no obstacle.
        """
        points = self._swing.points(p_from, p_to, normal_W)
        away = np.minimum(_squared(points - p_from), _squared(points - p_to[:, None]))
        points[away <= self._radius_m**2, 2] = np.inf
        return _meets(ground, self._foot.lowest_centre(ground.patch.height_m), points)


def _meets(ground: FootholdHeightmap, lowest_m: np.ndarray, points: np.ndarray) -> np.ndarray:
    """(n,) whether any of (n, s, 3) points is lower than a ball around it may come."""
    lower = points[..., 2] < ground.at(lowest_m, points, -np.inf)
    return np.any(lower, axis=1)


def _between(start: np.ndarray, end: np.ndarray, shares: np.ndarray) -> np.ndarray:
    """(n, s, 3) points at shares (s,) of the ways from (n, 3) to (n, 3)."""
    return start[:, None] + shares[:, None] * (end - start)[:, None]


def _shares(first: float, cells: float) -> np.ndarray:
    """Points from `first` to the end of a link that is `cells` long, no farther than a cell apart."""
    return np.linspace(first, 1.0, ceil((1.0 - first) * cells) + 1)


def _squared(d: np.ndarray) -> np.ndarray:
    """Squared horizontal length of vectors (..., 3)."""
    return d[..., 0] ** 2 + d[..., 1] ** 2


def _radius(shape: Primitive) -> float:
    """Radius of a link [m]: half the larger side of a box that runs along z, or a cylinder's own."""
    return 0.5 * max(shape.size[:2]) if shape.shape == "box" else shape.size[0]
