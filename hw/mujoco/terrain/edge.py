"""Rigid ground with one step down: a foot can stand so near to it that half its pad has nothing below."""

from __future__ import annotations

import mujoco

from surefoot.config.terrain import Terrain
from surefoot.hw.mujoco.terrain.section import Draw, Place, Section, add_block


def edge_section(terrain: Terrain, draw: Draw) -> Section:
    """A drop whose place and depth are drawn."""
    edge, rng = terrain.edge, draw("edge")
    at = edge.distance_m + edge.distance_spread_m * rng.uniform(-1.0, 1.0)
    drop = rng.uniform(edge.drop_min_m, edge.drop_max_m)

    def add(spec: mujoco.MjSpec, place: Place) -> None:
        x_drop, x1 = place.x0 + at, place.x0 + edge.length_m
        add_block(spec, f"{place.prefix}high", place.x0, x_drop, place.z0, place.floor_z)
        add_block(spec, f"{place.prefix}low", x_drop, x1, place.z0 - drop, place.floor_z)

    return Section(((0.0, 0.0), (at, 0.0), (at, -drop), (edge.length_m, -drop)), drop, add)
