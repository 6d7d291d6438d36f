"""Terrains built in code from their typed descriptions: one small file each."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import mujoco

from surefoot.config.robot import Robot
from surefoot.config.terrain import Terrain
from surefoot.hw.mujoco.terrain.flat import add_flat
from surefoot.hw.mujoco.terrain.planks import add_planks


@dataclass(frozen=True)
class Field:
    """Where the terrain to be crossed lies along the world's x axis [m]."""

    start_x: float
    end_x: float


_BUILDERS: dict[str, Callable] = {"flat": add_flat, "planks": add_planks}


def add_terrain(spec: mujoco.MjSpec, terrain: Terrain, robot: Robot) -> Field:
    """Add the terrain's bodies and geoms; the surface under the robot's start is z = 0.

    The robot starts with its trunk at x = y = 0, so its front feet stand at the hips' x.
    """
    front_x = robot.legs["FL"].hip_p_B[0] + robot.foot.radius
    start_x, end_x = _BUILDERS[terrain.kind](spec, terrain, front_x)
    return Field(start_x, end_x)
