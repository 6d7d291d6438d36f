"""A rigid plane: every alarm on it is false."""

from __future__ import annotations

import mujoco

from surefoot.config.terrain import Terrain
from surefoot.hw.mujoco.robot_body import TERRAIN_BITS

CROSSED_AFTER_M = 0.5
"""What counts as having crossed the plane: this far beyond the front feet's start."""


def add_flat(spec: mujoco.MjSpec, terrain: Terrain, front_x: float) -> tuple[float, float]:
    """Add the plane; returns start and end x of what is to be crossed [m]."""
    spec.worldbody.add_geom(
        name="ground",
        type=mujoco.mjtGeom.mjGEOM_PLANE,
        size=[20.0, 20.0, 0.1],
        rgba=[0.55, 0.58, 0.55, 1.0],
        **TERRAIN_BITS,
    )
    return front_x, front_x + CROSSED_AFTER_M
