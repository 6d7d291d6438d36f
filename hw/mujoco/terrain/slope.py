"""Planks on an incline between level ground at its foot and at its head."""

from __future__ import annotations

from math import radians

from surefoot.config.terrain import Terrain
from surefoot.hw.mujoco.terrain.planks import planks_section
from surefoot.hw.mujoco.terrain.section import Draw, Section


def slope_section(terrain: Terrain, draw: Draw) -> Section:
    """The planks of `terrain.planks`, turned about the line where they begin."""
    slope = terrain.slope
    angle_deg = draw("slope").uniform(slope.angle_min_deg, slope.angle_max_deg)
    return planks_section(terrain, draw, incline=radians(angle_deg))
