"""How far a foothold is from where the ground drops."""

from __future__ import annotations

import mujoco
import numpy as np

from surefoot.config.deployment import Deployment
from surefoot.hw.mujoco.scene import build_scene

WITH_DROP = ("edge",)
"""Kinds of terrain whose footholds are measured."""

_LOOK_M = 0.20  # to both sides along x
_STEP_M = 0.001
_DROP_M = 0.005  # over one step; a slope that drops as much is a wall
_ABOVE_M = 1.0
_NOTHING_M = -10.0  # height where there is no ground at all


class Drop:
    """The terrain's drops along x, by rays from above, in a scene without the robot."""

    def __init__(self, deployment: Deployment):
        self._model, _ = build_scene(deployment, None, deployment.hw.friction_max)
        self._data = mujoco.MjData(self._model)
        mujoco.mj_kinematics(self._model, self._data)
        self._radius = deployment.load_robot().foot.radius

    def distance(self, p_WF: np.ndarray) -> float | None:
        """Distance along x from a foot's centre (3,) to the nearest drop beside the ground on which it stands [m].

        Negative when the centre is past the drop and the foot still stands on its upper edge; None when the foot
        stands on the lower ground, or no drop is within 20 cm.
        """
        x, y, z = p_WF.tolist()
        xs = x + np.arange(-_LOOK_M, _LOOK_M, _STEP_M)
        heights = np.array([self._height(each, y) for each in xs])
        distances = []
        for at in np.flatnonzero(np.abs(np.diff(heights)) > _DROP_M):
            before, after = heights[at], heights[at + 1]
            if z - self._radius < 0.5 * (before + after):
                continue
            towards = 1.0 if after < before else -1.0
            distances.append(towards * float(0.5 * (xs[at] + xs[at + 1]) - x))
        return min(distances, key=abs, default=None)

    def _height(self, x: float, y: float) -> float:
        start, down = np.array([x, y, _ABOVE_M]), np.array([0.0, 0.0, -1.0])
        hit = np.zeros(1, np.int32)
        depth = mujoco.mj_ray(self._model, self._data, start, down, None, True, -1, hit)
        return _ABOVE_M - depth if depth >= 0.0 else _NOTHING_M
