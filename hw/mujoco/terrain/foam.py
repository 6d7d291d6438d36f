"""Soft pads that bear: under a force F a pad of stiffness k comes to rest F / k lower (Kelvin-Voigt)."""

from __future__ import annotations

import mujoco
import numpy as np

from surefoot.config.robot import GRAVITY
from surefoot.config.terrain import Foam, Terrain
from surefoot.hw.mujoco.robot_body import TERRAIN_BITS
from surefoot.hw.mujoco.terrain.section import Draw, Place, Section, let_sleep

_BODY_SHARE = 0.75  # a pad is pressed down to this share of its thickness at most
_COLORS = ((0.86, 0.78, 0.42, 1.0), (0.80, 0.71, 0.36, 1.0))


def foam_section(terrain: Terrain, draw: Draw) -> Section:
    """Pads whose softness is drawn."""
    foam = terrain.foam
    sinks_m = draw("foam").uniform(foam.sink_min_m, foam.sink_max_m, (foam.rows, foam.columns))
    pitch = foam.pad_m + foam.gap_m

    def add(spec: mujoco.MjSpec, place: Place) -> None:
        for (row, column), sink_m in np.ndenumerate(sinks_m):
            pos = [place.x0 + (row + 0.5) * pitch, (column + 0.5 - 0.5 * foam.columns) * pitch, place.z0]
            color = _COLORS[(row + column) % 2]
            name = f"{place.prefix}pad_{row}_{column}"
            _add_pad(spec, name, np.array(pos), foam, foam.force_n / sink_m, color)

    return Section(((0.0, 0.0), (foam.rows * pitch, 0.0)), foam.thickness_m, add)


def _add_pad(
    spec: mujoco.MjSpec, name: str, pos: np.ndarray, foam: Foam, stiffness: float, color: tuple[float, ...]
) -> None:
    body = spec.worldbody.add_body(name=name, pos=pos)
    body.add_joint(
        name=name,
        type=mujoco.mjtJoint.mjJNT_SLIDE,
        axis=[0.0, 0.0, 1.0],
        limited=mujoco.mjtLimited.mjLIMITED_TRUE,
        range=[-_BODY_SHARE * foam.thickness_m, 0.0],
        stiffness=[stiffness, 0.0, 0.0],
        springref=foam.mass * GRAVITY / stiffness,  # level under its own weight
        damping=[stiffness * foam.relaxation_s, 0.0, 0.0],
    )
    body.add_geom(
        name=name,
        type=mujoco.mjtGeom.mjGEOM_BOX,
        size=[0.5 * foam.pad_m, 0.5 * foam.pad_m, 0.5 * (1.0 - _BODY_SHARE) * foam.thickness_m],
        pos=[0.0, 0.0, -0.5 * (1.0 - _BODY_SHARE) * foam.thickness_m],
        mass=foam.mass,
        rgba=color,
        **TERRAIN_BITS,
    )
    let_sleep(spec, body)
