"""Terrains built in code from their typed descriptions: one small file each."""

from __future__ import annotations

from bisect import bisect_right
from collections.abc import Callable
from dataclasses import dataclass
from functools import cache

import mujoco

from surefoot.config.robot import Robot
from surefoot.config.terrain import Terrain
from surefoot.hw.mujoco.plant import stream
from surefoot.hw.mujoco.robot_body import TERRAIN_BITS
from surefoot.hw.mujoco.terrain.edge import edge_section
from surefoot.hw.mujoco.terrain.foam import foam_section
from surefoot.hw.mujoco.terrain.planks import planks_section
from surefoot.hw.mujoco.terrain.rocks import rocks_section
from surefoot.hw.mujoco.terrain.section import FLOOR_RGBA, RIGID_RGBA, Draw, Place, Profile, Section, add_block
from surefoot.hw.mujoco.terrain.slope import slope_section
from surefoot.hw.mujoco.terrain.tiles import tiles_section, trap_section

FLAT_CROSSED_M = 0.5
"""What counts as having crossed a plane: this far beyond the front feet's start."""

SECTIONS: dict[str, Callable[[Terrain, Draw], Section]] = {
    "planks": planks_section,
    "slope": slope_section,
    "rocks": rocks_section,
    "tiles": tiles_section,
    "foam": foam_section,
    "trap": trap_section,
    "edge": edge_section,
}


@dataclass(frozen=True)
class Field:
    """Where the terrain to be crossed lies along the world's x axis, and its nominal surface [m]."""

    start_x: float
    end_x: float
    profile: Profile = ((0.0, 0.0),)

    def level(self, x: float) -> float:
        """Height of the nominal surface at x: 0 but on an incline and after a step [m]."""
        after = bisect_right(self.profile, x, key=lambda point: point[0])
        if after == 0 or after == len(self.profile):
            return self.profile[max(after - 1, 0)][1]
        (x0, z0), (x1, z1) = self.profile[after - 1 : after + 1]
        return z0 + (z1 - z0) * (x - x0) / (x1 - x0)


def add_terrain(spec: mujoco.MjSpec, terrain: Terrain, robot: Robot, seed: int) -> Field:
    """Add the terrain's bodies and geoms; the surface under the robot's start is z = 0.

    The robot starts with its trunk at x = y = 0, so its front feet stand at the hips' x.

    Args:
        spec: the scene so far.
        terrain: description.
        robot: who starts on it.
        seed: what the description leaves to chance is drawn from it.
    """
    front_x = robot.legs["FL"].hip_p_B[0] + robot.foot.radius
    approach = terrain.approach
    if approach is None:
        _add_ground(spec, 0.0)
        return Field(front_x, front_x + FLAT_CROSSED_M)
    start_x = front_x + approach.start_offset_m
    placed, profile = _in_a_row(_sections(terrain, cache(lambda name: stream(seed, name))), start_x)
    floor_z = min(z0 - section.depth_m for section, _, _, z0 in placed)
    _add_ground(spec, floor_z)
    end_x, end_z = profile[-1]
    add_block(spec, "run_up", start_x - approach.run_up_m, start_x, 0.0, floor_z)
    add_block(spec, "run_out", end_x, end_x + approach.run_out_m, end_z, floor_z)
    for section, prefix, x0, z0 in placed:
        section.add(spec, Place(x0, z0, floor_z, prefix))
    return Field(start_x, end_x, profile)


def _sections(terrain: Terrain, draw: Draw) -> list[tuple[Section, str]]:
    """All that stands in a row, and what the names of its bodies begin with."""
    sections: list[tuple[Section, str]] = []
    for number, kind in enumerate(terrain.row):
        if number:
            sections.append((_platform(terrain.lane.platform_m), f"{number}_"))
        sections.append((SECTIONS[kind](terrain, draw), f"{number}_" if terrain.kind == "lane" else ""))
    return sections


def _platform(length_m: float) -> Section:
    """Rigid level ground."""

    def add(spec: mujoco.MjSpec, place: Place) -> None:
        add_block(spec, f"{place.prefix}platform", place.x0, place.x0 + length_m, place.z0, place.floor_z)

    return Section(((0.0, 0.0), (length_m, 0.0)), 0.0, add)


def _in_a_row(
    sections: list[tuple[Section, str]], x: float
) -> tuple[list[tuple[Section, str, float, float]], Profile]:
    """Each section with its prefix and where it begins, from x on, and the surface over them all."""
    z = 0.0
    placed: list[tuple[Section, str, float, float]] = []
    profile: list[tuple[float, float]] = []
    for section, prefix in sections:
        placed.append((section, prefix, x, z))
        profile += [(x + ahead, z + up) for ahead, up in section.profile]
        x, z = profile[-1]
    return placed, tuple(profile)


def _add_ground(spec: mujoco.MjSpec, z: float) -> None:
    spec.worldbody.add_geom(
        name="ground",
        type=mujoco.mjtGeom.mjGEOM_PLANE,
        size=[20.0, 20.0, 0.1],
        pos=[0.0, 0.0, z],
        rgba=RIGID_RGBA if z == 0.0 else FLOOR_RGBA,
        **TERRAIN_BITS,
    )
