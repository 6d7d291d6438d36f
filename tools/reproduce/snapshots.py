"""Pictures of recorded instants, rendered off screen after the run and apart from it."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from surefoot.tools.offscreen import BACKENDS, NO_RENDERER, Offscreen
from surefoot.tools.reproduce.run_spec import RunSpec

SIZE = (720, 480)
"""Width and height of a picture in pixels."""

_QUALITY = 88  # of JPEG: text-free pictures show no trace of it


@dataclass(frozen=True)
class View:
    """Where a picture is taken from.

    Attributes:
        lookat_W: (3,) what stands in its middle [m].
        azimuth, elevation: direction of sight [degrees]; azimuth 0 looks along x, 90 along y; elevation up.
        distance_m: from the camera to that point.
    """

    lookat_W: tuple[float, float, float]
    azimuth: float
    elevation: float = -20.0
    distance_m: float = 1.2


@dataclass(frozen=True)
class Shot:
    """One picture: joint positions as recorded, a view, and the file."""

    qpos: np.ndarray
    view: View
    path: Path


def on_foot(foot_W: np.ndarray, leg: int, distance_m: float = 1.15) -> View:
    """A foot and the ground under it from its own side: a front foot seen from ahead, a hind foot from abreast."""
    side = -1.0 if leg in (0, 2) else 1.0
    azimuth = 128.0 if leg in (0, 1) else 82.0
    x, y, z = (float(each) for each in foot_W)
    return View((x - 0.08, y, z + 0.12), side * azimuth, -16.0, distance_m)


def whole_robot(p_WB: np.ndarray, azimuth: float = 62.0, distance_m: float = 1.75) -> View:
    """The whole robot from its right side, walking to the right."""
    return View((float(p_WB[0]) + 0.1, float(p_WB[1]), 0.12), azimuth, -20.0, distance_m)


class Darkroom:
    """Renders shots with the first backend that works here."""

    def __init__(self, backends: Sequence[str] = BACKENDS):
        self._offscreen = Offscreen(backends)

    def develop(self, spec: RunSpec, shots: Sequence[Shot]) -> str:
        """Render shots of one deployment to their files; returns why there are none, or nothing."""
        if not shots:
            return ""
        told = self._offscreen.run(render, (spec, list(shots)))
        return f"not rendered: {told['failure']}" if "failure" in told else told.get(NO_RENDERER, "")


def render(spec: RunSpec, shots: Sequence[Shot]) -> dict:
    """Render in this process with the backend of its environment; says what fails of the backend itself."""
    try:
        import mujoco

        from surefoot.hw.mujoco.scene import build_scene

        deployment = spec.deployment()
        model, _ = build_scene(deployment, deployment.load_robot(), friction=0.6)
        width, height = SIZE
        renderer = mujoco.Renderer(model, height, width)
    except Exception as error:  # what is missing of GL shows as almost any kind of error
        return {NO_RENDERER: f"{type(error).__name__}: {error}"}
    from PIL import Image

    data = mujoco.MjData(model)
    camera = mujoco.MjvCamera()
    for shot in shots:
        data.qpos[:] = shot.qpos
        mujoco.mj_kinematics(model, data)
        mujoco.mj_camlight(model, data)
        camera.lookat[:] = shot.view.lookat_W
        camera.azimuth, camera.elevation = shot.view.azimuth, shot.view.elevation
        camera.distance = shot.view.distance_m
        renderer.update_scene(data, camera)
        Image.fromarray(renderer.render()).save(shot.path, quality=_QUALITY)
    renderer.close()
    return {}
