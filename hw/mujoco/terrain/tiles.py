"""Tiles that bear a drawn load and then give way: the support of each weakens as it yields.

At a sinking s the support pushes with F(s) = R + (P + W - R) (1 - s/T)^3: at the upper stop with the load P that
it gives way at and the tile's weight W, at the lower stop T with the return force R, which brings it up again
once it is unloaded. Where F falls with s nothing is in balance between the stops: the tile snaps through. A brake
that grows with the cube of the speed lets the snap begin at once and yet keeps tiles from flying up under a foot.
"""

from __future__ import annotations

from math import cbrt

import mujoco
import numpy as np

from surefoot.config.robot import GRAVITY
from surefoot.config.terrain import Terrain, Tiles
from surefoot.hw.mujoco.robot_body import TERRAIN_BITS
from surefoot.hw.mujoco.terrain.section import Draw, Place, Section, let_sleep

_THICKNESS_M = 0.02
_COLORS = ((0.62, 0.66, 0.72, 1.0), (0.54, 0.58, 0.65, 1.0))
_STOP_TIME_S, _STOP_IMPEDANCE = 0.003, 0.99  # stiff: a tile that dips would snap below its load


def tiles_section(terrain: Terrain, draw: Draw) -> Section:
    """Tiles whose loads are drawn."""
    return _section(terrain.tiles, draw("tiles"))


def trap_section(terrain: Terrain, draw: Draw) -> Section:
    """Tiles of which none bears a foot."""
    return _section(terrain.trap, draw("trap"))


def _section(tiles: Tiles, rng: np.random.Generator) -> Section:
    loads_n = rng.uniform(tiles.load_min_n, tiles.load_max_n, (tiles.rows, tiles.columns))
    pitch = tiles.tile_m + tiles.gap_m

    def add(spec: mujoco.MjSpec, place: Place) -> None:
        for (row, column), load_n in np.ndenumerate(loads_n):
            pos = [
                place.x0 + (row + 0.5) * pitch,
                (column + 0.5 - 0.5 * tiles.columns) * pitch,
                place.z0,
            ]
            color = _COLORS[(row + column) % 2]
            _add_tile(spec, f"{place.prefix}tile_{row}_{column}", np.array(pos), tiles, load_n, color)

    return Section(((0.0, 0.0), (tiles.rows * pitch, 0.0)), tiles.frame_height_m, add)


def support_polynomial(
    load_n: float, weight_n: float, return_n: float, travel_m: float
) -> tuple[float, list[float]]:
    """Spring that pushes as the module says: reference [m] and coefficients k0, k1, k2 of MuJoCo's polynomial.

    MuJoCo's spring pushes with -(k0 x + k1 x^2 + k2 x^3) at x = q - reference, q = -s; the reference is where the
    cubic has its one real root.
    """
    least = weight_n + return_n
    drop = load_n + weight_n - least
    root = cbrt(least / drop)
    scale = -drop / travel_m**3
    return -travel_m * (1.0 + root), [3.0 * scale * (travel_m * root) ** 2, -3.0 * scale * travel_m * root, scale]


def _stop_gives_m(force_n: float, mass: float) -> float:
    """How far MuJoCo's soft joint limit yields to a steady force: at rest f = m d^2 r / ((1 - d) (d T)^2).

    d is the constraint's impedance and T its time constant (MuJoCo's documentation, Computation, "Parameters").
    """
    return force_n * (1.0 - _STOP_IMPEDANCE) * _STOP_TIME_S**2 / mass


def _add_tile(
    spec: mujoco.MjSpec, name: str, pos: np.ndarray, tiles: Tiles, load_n: float, color: tuple[float, ...]
) -> None:
    reference, stiffness = support_polynomial(load_n, tiles.mass * GRAVITY, tiles.return_n, tiles.travel_m)
    body = spec.worldbody.add_body(name=name, pos=pos)
    body.add_joint(
        name=name,
        type=mujoco.mjtJoint.mjJNT_SLIDE,
        axis=[0.0, 0.0, 1.0],
        limited=mujoco.mjtLimited.mjLIMITED_TRUE,
        # The support presses the tile level against the stop; a tile that begins asleep must begin in balance.
        range=[-tiles.travel_m, -_stop_gives_m(load_n, tiles.mass)],
        stiffness=stiffness,
        springref=reference,
        damping=[tiles.damping, 0.0, tiles.brake],
        solref_limit=[_STOP_TIME_S, 1.0],
        solimp_limit=[_STOP_IMPEDANCE, _STOP_IMPEDANCE, 0.001, 0.5, 2.0],
    )
    body.add_geom(
        name=name,
        type=mujoco.mjtGeom.mjGEOM_BOX,
        size=[0.5 * tiles.tile_m, 0.5 * tiles.tile_m, 0.5 * _THICKNESS_M],
        pos=[0.0, 0.0, -0.5 * _THICKNESS_M],
        mass=tiles.mass,
        rgba=color,
        **TERRAIN_BITS,
    )
    let_sleep(spec, body)
