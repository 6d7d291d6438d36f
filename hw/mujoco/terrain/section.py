"""What a section of terrain is given, what it answers, and the rigid ground around it."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import mujoco
import numpy as np

from surefoot.hw.mujoco.robot_body import TERRAIN_BITS

RIGID_RGBA = (0.55, 0.58, 0.55, 1.0)
FLOOR_RGBA = (0.4, 0.4, 0.42, 1.0)
HALF_WIDTH_M = 1.0
"""Half the width of rigid platforms."""

Profile = tuple[tuple[float, float], ...]
"""Points (x, z) of the nominal surface [m], in the order of x; twice the same x is a step."""


Draw = Callable[[str], np.random.Generator]
"""The random stream of a name, one for all sections of a terrain: two of a kind differ."""


@dataclass(frozen=True)
class Place:
    """Where a section stands: it begins at (x0, z0), above ground at floor_z [m]; its names begin with prefix."""

    x0: float
    z0: float
    floor_z: float
    prefix: str


@dataclass(frozen=True)
class Section:
    """A stretch of terrain, all drawn, not yet in a scene.

    Attributes:
        profile: its nominal surface, from (0, 0) to where it ends.
        depth_m: how deep the ground beneath has to lie under the section's beginning; 0: it stands on that ground.
        add: puts its bodies into a scene at a place.
    """

    profile: Profile
    depth_m: float
    add: Callable[[mujoco.MjSpec, Place], None]


def add_block(spec: mujoco.MjSpec, name: str, x0: float, x1: float, z: float, floor_z: float) -> None:
    """Rigid ground from x0 to x1 at height z, down to the ground beneath; nothing where it is that ground."""
    height = z - floor_z
    if height <= 0.0 or x1 <= x0:
        return
    spec.worldbody.add_geom(
        name=name,
        type=mujoco.mjtGeom.mjGEOM_BOX,
        size=[0.5 * (x1 - x0), HALF_WIDTH_M, 0.5 * height],
        pos=[0.5 * (x0 + x1), 0.0, z - 0.5 * height],
        rgba=RIGID_RGBA,
        **TERRAIN_BITS,
    )


def let_sleep(spec: mujoco.MjSpec, body: mujoco.MjsBody) -> None:
    """A body that begins at rest costs nothing until the robot, or what it moves, touches it."""
    spec.option.enableflags |= mujoco.mjtEnableBit.mjENBL_SLEEP
    body.sleep = mujoco.mjtSleepPolicy.mjSLEEP_INIT
