"""Loose stones on flat rigid ground: convex, heavy, each with flat sides that it comes to lie on."""

from __future__ import annotations

from dataclasses import dataclass
from functools import lru_cache

import mujoco
import numpy as np

from surefoot.config.robot import GRAVITY
from surefoot.config.terrain import Rocks, Terrain
from surefoot.hw.mujoco.robot_body import LOOSE_BITS, TERRAIN_BITS
from surefoot.hw.mujoco.terrain.section import Draw, Place, Section, add_block, let_sleep

_WALLS = ("front", "back", "right", "left")
_WIDE = (20.0, 20.0, 0.1)
_CORNERS = 16
_FLAT_AT = 0.6  # a stone's top and bottom are cut off at this share of its half height
_GREYS = ((0.52, 0.50, 0.47, 1.0), (0.45, 0.44, 0.43, 1.0), (0.60, 0.57, 0.52, 1.0))

# Coming to rest.
_DT = 0.002
_SETTLE_LEAST_S = 1.5  # between the walls, and again without
_SETTLE_MOST_S = 6.0
_STILL = 0.02  # slower than this they lie [m/s, rad/s]
_DRAG = 10.0  # rate at which a falling stone loses its momentum: they are laid down, not thrown [1/s]
_FRICTION = 0.4  # the least of a run by default: what rests with it rests with more
_SOLREF, _SOLIMP = (0.005, 1.0), (0.95, 0.99, 0.001, 0.5, 2.0)  # stiff contacts, or stones creep and jump
_GAP_M = 0.01
_INSET_M = 0.03  # of the walls: without them the stones spread a little


@dataclass(frozen=True)
class Stone:
    """One stone at rest.

    Attributes:
        vertices: (n, 3) corners in its own frame [m].
        density: [kg/m^3].
        pos: (3,) of its frame, from the middle of the field's beginning [m].
        quat: (4,) orientation, w first.
    """

    vertices: np.ndarray
    density: float
    pos: np.ndarray
    quat: np.ndarray


def rocks_section(terrain: Terrain, draw: Draw) -> Section:
    """Stones drawn, laid down and settled."""
    rocks = terrain.rocks
    stones = settled_stones(rocks, int(draw("rocks").integers(2**62)))

    def add(spec: mujoco.MjSpec, place: Place) -> None:
        add_block(spec, f"{place.prefix}bed", place.x0, place.x0 + rocks.length_m, place.z0, place.floor_z)
        for index, stone in enumerate(stones):
            body = _add_stone(spec, f"{place.prefix}rock_{index}", stone, index)
            body.pos = stone.pos + [place.x0, 0.0, place.z0]
            let_sleep(spec, body)

    return Section(((0.0, 0.0), (rocks.length_m, 0.0)), 0.0, add)


@lru_cache(maxsize=16)
def settled_stones(rocks: Rocks, seed: int) -> tuple[Stone, ...]:
    """Draw stones, lay them down between walls, without a robot, and wait until they lie still."""
    rng = np.random.default_rng(seed)
    stones = [
        Stone(_vertices(rocks, rng), rng.uniform(rocks.density_min, rocks.density_max), pos, quat)
        for pos, quat in _laid_out(rocks, rng)
    ]
    spec = _between_walls(rocks)
    for index, stone in enumerate(stones):
        _add_stone(spec, f"rock_{index}", stone, index)
    for geom in spec.geoms:
        geom.friction, geom.solref, geom.solimp = [_FRICTION, 0.005, 0.0001], _SOLREF, _SOLIMP
    model = spec.compile()
    model.dof_damping[:] = _DRAG * model.dof_M0
    data = mujoco.MjData(model)
    _settle(model, data)
    for name in _WALLS:
        model.geom(name).contype[0] = model.geom(name).conaffinity[0] = 0
    _settle(model, data)
    poses = data.qpos.reshape(-1, 7)
    return tuple(
        Stone(stone.vertices, stone.density, pose[:3].copy(), pose[3:] / np.linalg.norm(pose[3:]))
        for stone, pose in zip(stones, poses, strict=True)
    )


def _settle(model: mujoco.MjModel, data: mujoco.MjData) -> None:
    since = data.time
    while data.time < since + _SETTLE_LEAST_S or (
        np.abs(data.qvel).max() > _STILL and data.time < since + _SETTLE_MOST_S
    ):
        mujoco.mj_step(model, data)


def _vertices(rocks: Rocks, rng: np.random.Generator) -> np.ndarray:
    """(n, 3) corners: points on an ellipsoid that is cut off flat above and below."""
    from scipy.spatial.distance import pdist  # a third of io's start, and most terrains have no stones

    # Small stones are many and large ones few: their number falls with the square of the size.
    size = 1.0 / rng.uniform(1.0 / rocks.size_max_m, 1.0 / rocks.size_min_m)
    points = rng.normal(size=(_CORNERS, 3))
    points /= np.linalg.norm(points, axis=1)[:, None]
    points[:, 2] = np.clip(points[:, 2], -_FLAT_AT, _FLAT_AT) / _FLAT_AT
    points *= [1.0, rng.uniform(0.6, 0.95), rng.uniform(rocks.flatness_min, rocks.flatness_max)]
    return points * size / pdist(points).max()


def _laid_out(rocks: Rocks, rng: np.random.Generator) -> list[tuple[np.ndarray, np.ndarray]]:
    """Poses in layers above the ground, no two touching, each flat and turned at random."""
    cell = rocks.size_max_m + _GAP_M
    room = np.array([rocks.length_m, rocks.width_m]) - 2.0 * _INSET_M
    across, along = (max(1, int(side / cell)) for side in room)
    pitch = room / [across, along]
    slack = 0.5 * np.maximum(pitch - cell, 0.0)
    poses: list[tuple[np.ndarray, np.ndarray]] = []
    layer = 0
    while len(poses) < rocks.count:
        for index in rng.permutation(across * along)[: rocks.count - len(poses)]:
            middle = (np.array(divmod(index, along)) + 0.5) * pitch + rng.uniform(-slack, slack)
            yaw = rng.uniform(-np.pi, np.pi)
            pos = np.array([_INSET_M + middle[0], middle[1] - 0.5 * room[1], (layer + 0.5) * cell])
            poses.append((pos, np.array([np.cos(0.5 * yaw), 0.0, 0.0, np.sin(0.5 * yaw)])))
        layer += 1
    return poses


def _between_walls(rocks: Rocks) -> mujoco.MjSpec:
    """Ground and four walls around the field."""
    spec = mujoco.MjSpec()
    spec.option.timestep = _DT
    spec.option.gravity = [0.0, 0.0, -GRAVITY]
    spec.option.integrator = mujoco.mjtIntegrator.mjINT_IMPLICITFAST
    spec.option.cone = mujoco.mjtCone.mjCONE_ELLIPTIC
    spec.option.impratio = 10.0
    spec.worldbody.add_geom(type=mujoco.mjtGeom.mjGEOM_PLANE, size=_WIDE, **TERRAIN_BITS)
    x, y, half = 0.5 * rocks.length_m - _INSET_M, 0.5 * rocks.width_m - _INSET_M, np.sqrt(0.5)
    corners = ([-x, 0.0, half, 0.0], [x, 0.0, -half, 0.0], [0.0, -y, 0.0, -half], [0.0, y, 0.0, half])
    for name, (at_x, at_y, turn_y, turn_x) in zip(_WALLS, corners, strict=True):
        spec.worldbody.add_geom(
            name=name,
            type=mujoco.mjtGeom.mjGEOM_PLANE,
            size=_WIDE,
            pos=[0.5 * rocks.length_m + at_x, at_y, 0.0],
            quat=[half, turn_x, turn_y, 0.0],
            **TERRAIN_BITS,
        )
    return spec


def _add_stone(spec: mujoco.MjSpec, name: str, stone: Stone, index: int) -> mujoco.MjsBody:
    spec.add_mesh(name=name, uservert=stone.vertices.ravel(), inertia=mujoco.mjtMeshInertia.mjMESH_INERTIA_CONVEX)
    body = spec.worldbody.add_body(name=name, pos=stone.pos, quat=stone.quat)
    body.add_freejoint(name=name)
    body.add_geom(
        name=name,
        type=mujoco.mjtGeom.mjGEOM_MESH,
        meshname=name,
        density=stone.density,
        rgba=_GREYS[index % len(_GREYS)],
        **LOOSE_BITS,
    )
    return body
