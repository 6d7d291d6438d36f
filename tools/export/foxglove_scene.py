"""The robot in three dimensions as Foxglove draws it: messages of its schema `foxglove.SceneUpdate`, in JSON.

Legs are lines, feet are balls, forces are arrows, verdicts on footholds are flat cylinders, in the frame `world`.
"""

from __future__ import annotations

import json
from collections.abc import Iterator, Sequence
from typing import Any

import numpy as np

from surefoot.components.robot_model import LegKinematics
from surefoot.components.robot_model.rotation import matrix_of
from surefoot.config.robot import Robot
from surefoot.tools.plot.verdict_looks import COLORS
from surefoot.tools.tables.recording_tables import RecordingTables
from surefoot.tools.video.scenes import Instant, Scenes, frame_times

TOPIC, SCHEMA_NAME = "scene", "foxglove.SceneUpdate"

RATE_HZ = 20.0
"""Enough for an eye."""

_FRAME = "world"
_ARROW_M_PER_N, _LEAST_N = 0.003, 5.0
_MARK_M, _THICKNESS_M = 0.1, 0.02  # a mark is to be seen around the foot that stands on it
_BODY, _LEG, _FOOT = "#40454d", "#d9732b", "#1d2126"
_CARRIES, _TURN = "#1f5fbf", "#e8850c"
_EMPTY = ("arrows", "cubes", "spheres", "cylinders", "lines", "triangles", "texts", "models", "metadata")
"""Lists that an entity has, if only empty ones."""


def scene_schema() -> bytes:
    """The schema of what is written here; Foxglove knows the rest by its name."""
    origin, ahead = np.zeros(3), np.array([1.0, 0.0, 0.0])
    solid = {"pose": _pose(origin), "size": _vector(ahead), "color": _color(_BODY)}
    line = _line(np.stack([origin, ahead])) | {"colors": [_color(_LEG)], "indices": [0]}
    parts = {"cubes": [solid], "spheres": [solid], "lines": [line]}
    entity = _entity("", 0, **parts, arrows=[_arrow(origin, ahead, _TURN)], cylinders=[_mark(origin, "accepted")])
    return json.dumps({"title": SCHEMA_NAME} | _schema_of({"deletions": [], "entities": [entity]})).encode()


def scene_updates(recording: RecordingTables, begin_s: float, end_s: float) -> Iterator[tuple[int, bytes]]:
    """(time [ns], message) `RATE_HZ` times a second, of the truth or, without it, of the estimate.

    Raises:
        NotRecorded: there is neither in that time.
    """
    robot = recording.deployment.load_robot()
    legs, under = LegKinematics(robot), np.array([0.0, 0.0, robot.foot.radius])
    for instant in Scenes(recording, frame_times(begin_s, end_s, RATE_HZ, 1.0)):
        t_ns = round(1e9 * instant.t)
        entities = [_entity("robot", t_ns, **_robot(instant, robot, legs))]
        marks = [_mark(p_WF - under, verdict) for p_WF, verdict in instant.verdicts]
        entities.append(_entity("verdicts", t_ns, cylinders=marks))
        yield t_ns, json.dumps({"deletions": [], "entities": entities}, allow_nan=False).encode()


def _schema_of(value: Any) -> dict[str, Any]:
    """The JSON schema that a value is an example of; a list without an example holds objects."""
    if isinstance(value, dict):
        return {"type": "object", "properties": {name: _schema_of(each) for name, each in value.items()}}
    if isinstance(value, list):
        return {"type": "array", "items": _schema_of(value[0] if value else {})}
    return {"type": {bool: "boolean", int: "integer", float: "number", str: "string"}[type(value)]}


def _entity(name: str, t_ns: int, **parts: Any) -> dict[str, Any]:
    """It stays until another of its name takes its place."""
    stamp = {"sec": t_ns // 10**9, "nsec": t_ns % 10**9}
    head = {"timestamp": stamp, "frame_id": _FRAME, "id": name, "lifetime": {"sec": 0, "nsec": 0}}
    return head | {"frame_locked": False} | {each: [] for each in _EMPTY} | parts


def _robot(instant: Instant, robot: Robot, legs: LegKinematics) -> dict[str, Any]:
    p_WB, quat_WB, q = instant.qpos[:3], instant.qpos[3:7], instant.qpos[7:19].reshape(4, 3)
    R_WB = matrix_of(quat_WB)
    thigh_B, knee_B = legs.joints(q)
    points = np.stack([legs.hip_B, thigh_B, knee_B], axis=1) @ R_WB.T + p_WB
    chains = np.concatenate([points, instant.p_WF[:, None]], axis=1)
    trunk = robot.collision["trunk"]
    return {
        "cubes": [
            {
                "pose": _pose(p_WB + R_WB @ np.array(trunk.center), quat_WB),
                "size": _vector(trunk.size),
                "color": _color(_BODY),
            }
        ],
        "lines": [_line(chain) for chain in chains],
        "spheres": [
            {"pose": _pose(foot), "size": _vector([2.0 * robot.foot.radius] * 3), "color": _color(_FOOT)}
            for foot in instant.p_WF
        ],
        "arrows": [
            _arrow(foot, force, _TURN if leg == instant.leg else _CARRIES)
            for leg, (foot, force) in enumerate(zip(instant.p_WF, instant.force_W, strict=True))
            if np.linalg.norm(force) > _LEAST_N
        ],
    }


def _line(points: np.ndarray) -> dict[str, Any]:
    return {
        "type": 0,  # from each point to the next
        "pose": _pose(np.zeros(3)),
        "thickness": _THICKNESS_M,
        "scale_invariant": False,
        "points": [_vector(point) for point in points],
        "color": _color(_LEG),
        "colors": [],
        "indices": [],
    }


def _arrow(begin_W: np.ndarray, force_W: np.ndarray, color: str) -> dict[str, Any]:
    length = _ARROW_M_PER_N * float(np.linalg.norm(force_W))
    return {
        "pose": _pose(begin_W, _from_x_to(force_W)),
        "shaft_length": 0.75 * length,
        "shaft_diameter": 0.015,
        "head_length": 0.25 * length,
        "head_diameter": 0.03,
        "color": _color(color),
    }


def _mark(place_W: np.ndarray, verdict: str) -> dict[str, Any]:
    size = _vector([_MARK_M, _MARK_M, 0.004])
    return {
        "pose": _pose(place_W),
        "size": size,
        "bottom_scale": 1.0,
        "top_scale": 1.0,
        "color": _color(COLORS[verdict]),
    }


def _from_x_to(direction: np.ndarray) -> np.ndarray:
    """(w, x, y, z) of the shortest turn of the x axis into a direction (3,)."""
    x, y, z = direction / np.linalg.norm(direction)
    if x < -1.0 + 1e-9:
        return np.array([0.0, 0.0, 0.0, 1.0])
    turn = np.array([1.0 + x, 0.0, -z, y])
    return turn / np.linalg.norm(turn)


def _pose(position: np.ndarray, quat: Sequence[float] | np.ndarray = (1.0, 0.0, 0.0, 0.0)) -> dict[str, Any]:
    w, x, y, z = (float(value) for value in quat)
    return {"position": _vector(position), "orientation": {"x": x, "y": y, "z": z, "w": w}}


def _vector(values: Sequence[float] | np.ndarray) -> dict[str, float]:
    x, y, z = (float(value) for value in values)
    return {"x": x, "y": y, "z": z}


def _color(hexadecimal: str) -> dict[str, float]:
    red, green, blue = (int(hexadecimal[at : at + 2], 16) / 255.0 for at in (1, 3, 5))
    return {"r": red, "g": green, "b": blue, "a": 0.9}
