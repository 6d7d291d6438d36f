"""The terrain of a run from above: what the simulator built of its description."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from surefoot.config.deployment import Deployment

_SIGNS = np.array([[x, y, z] for x in (-1.0, 1.0) for y in (-1.0, 1.0) for z in (-1.0, 1.0)])


@dataclass(frozen=True)
class Outline:
    """One block of the terrain.

    Attributes:
        corners: (n, 2) anticlockwise, in the world [m].
        rgb: its colour in the simulator.
        top_m: how high it is.
    """

    corners: np.ndarray
    rgb: tuple[float, float, float]
    top_m: float


def outlines(deployment: Deployment) -> list[Outline]:
    """The blocks of a simulated terrain as it begins, lowest first; none of flat ground or a real robot."""
    if deployment.hw.backend != "mujoco" or not deployment.terrain.row:
        return []
    import mujoco
    from scipy.spatial import ConvexHull

    from surefoot.hw.mujoco.scene import build_scene

    model, _ = build_scene(deployment, None, friction=deployment.hw.friction_max)
    data = mujoco.MjData(model)
    mujoco.mj_kinematics(model, data)
    found = []
    for geom in np.flatnonzero(model.geom_type == mujoco.mjtGeom.mjGEOM_BOX):
        points = data.geom_xpos[geom] + _SIGNS * model.geom_size[geom] @ data.geom_xmat[geom].reshape(3, 3).T
        red, green, blue, alpha = model.geom_rgba[geom].tolist()
        if alpha > 0.0:
            corners = points[ConvexHull(points[:, :2]).vertices, :2]
            found.append(Outline(corners, (red, green, blue), float(points[:, 2].max())))
    return sorted(found, key=lambda outline: outline.top_m)
