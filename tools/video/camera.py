"""Draws one instant into an image: the simulator's scene, arrows for forces, marks for verdicts, a few words."""

from __future__ import annotations

import mujoco
import numpy as np

from surefoot.config.deployment import Deployment
from surefoot.hw.mujoco.scene import build_scene
from surefoot.tools.plot.verdict_looks import COLORS
from surefoot.tools.video.scenes import Instant

_MOST_GEOMS = 20_000
_AZIMUTH, _ELEVATION, _DISTANCE_M = 62.0, -22.0, 1.7
_AHEAD_M, _LOOKAT_Z = 0.1, 0.12
_ARROW_M_PER_N, _ARROW_WIDTH_M = 0.003, 0.011
_LEAST_N = 5.0  # a force that is worth an arrow
_MARK_M = 0.036
_ROBOT_QPOS = 19  # trunk position and quaternion, twelve joints
_CARRIES, _TURN = (0.20, 0.45, 0.85, 0.9), (0.95, 0.50, 0.05, 0.95)


class Camera:
    """Looks at the robot from its right side and goes along with it."""

    def __init__(self, deployment: Deployment, width: int, height: int):
        """Any error that this raises is the renderer's, unless the deployment cannot be built."""
        robot = deployment.load_robot()
        self._model, _ = build_scene(deployment, robot, friction=deployment.hw.friction_max)
        self._model.vis.global_.offwidth, self._model.vis.global_.offheight = width, height
        self._foot_m = robot.foot.radius
        self._data = mujoco.MjData(self._model)
        self._gl = mujoco.GLContext(width, height)
        self._gl.make_current()
        self._scene = mujoco.MjvScene(self._model, maxgeom=_MOST_GEOMS)
        for flag in (mujoco.mjtRndFlag.mjRND_SHADOW, mujoco.mjtRndFlag.mjRND_REFLECTION):
            self._scene.flags[flag] = False  # five times as fast where a processor draws
        scale = mujoco.mjtFontScale.mjFONTSCALE_150 if height >= 480 else mujoco.mjtFontScale.mjFONTSCALE_100
        self._context = mujoco.MjrContext(self._model, scale.value)
        mujoco.mjr_setBuffer(mujoco.mjtFramebuffer.mjFB_OFFSCREEN.value, self._context)
        self._view, self._option = mujoco.MjvCamera(), mujoco.MjvOption()
        self._view.azimuth, self._view.elevation, self._view.distance = _AZIMUTH, _ELEVATION, _DISTANCE_M
        self._rect = mujoco.MjrRect(0, 0, width, height)
        self._pixels = np.empty((height, width, 3), np.uint8)

    def picture(self, instant: Instant) -> np.ndarray:
        """(height, width, 3) RGB.

        Raises:
            ValueError: the positions are of another scene.
        """
        self._pose(instant.qpos)
        x, y, _ = instant.lookat_W.tolist()
        self._view.lookat[:] = (x + _AHEAD_M, y, _LOOKAT_Z)
        mujoco.mjv_updateScene(
            self._model, self._data, self._option, None, self._view, mujoco.mjtCatBit.mjCAT_ALL, self._scene
        )
        for foot, force in enumerate(instant.force_W):
            if np.linalg.norm(force) > _LEAST_N:
                color = _TURN if foot == instant.leg else _CARRIES
                self._arrow(instant.p_WF[foot], instant.p_WF[foot] + _ARROW_M_PER_N * force, color)
        for place, verdict in instant.verdicts:
            self._mark(place, verdict)
        mujoco.mjr_render(self._rect, self._scene, self._context)
        names, values = ("\n".join(column) for column in zip(*instant.lines, strict=True))
        font, corner = mujoco.mjtFont.mjFONT_NORMAL, mujoco.mjtGridPos.mjGRID_TOPLEFT
        mujoco.mjr_overlay(font, corner, self._rect, names, values, self._context)
        mujoco.mjr_readPixels(self._pixels, None, self._rect, self._context)
        return self._pixels[::-1]

    def close(self) -> None:
        """Give the renderer back; before the interpreter ends, or it complains."""
        self._context.free()
        self._gl.free()

    def _pose(self, qpos: np.ndarray) -> None:
        """Without truth only the robot is known: what else can move stays as it was built."""
        known = len(qpos)
        if known not in (_ROBOT_QPOS, self._model.nq):
            raise ValueError(f"{known} positions for a scene of {self._model.nq}: it was made with other settings")
        self._data.qpos[:known] = qpos
        mujoco.mj_kinematics(self._model, self._data)
        mujoco.mj_camlight(self._model, self._data)

    def _arrow(self, begin_W: np.ndarray, end_W: np.ndarray, rgba: tuple[float, ...]) -> None:
        geom = self._next(mujoco.mjtGeom.mjGEOM_ARROW, rgba)
        mujoco.mjv_connector(geom, mujoco.mjtGeom.mjGEOM_ARROW, _ARROW_WIDTH_M, begin_W, end_W)

    def _mark(self, place_W: np.ndarray, verdict: str) -> None:
        color = COLORS[verdict]
        rgba = tuple(int(color[at : at + 2], 16) / 255.0 for at in (1, 3, 5))
        geom = self._next(mujoco.mjtGeom.mjGEOM_CYLINDER, (*rgba, 0.85))
        geom.size[:] = (_MARK_M, _MARK_M, 0.002)
        geom.pos[:] = place_W - [0.0, 0.0, self._foot_m - 0.002]

    def _next(self, kind: int, rgba: tuple[float, ...]) -> mujoco.MjvGeom:
        geom = self._scene.geoms[self._scene.ngeom]
        zeros = np.zeros(3)
        mujoco.mjv_initGeom(geom, kind, zeros, zeros, np.eye(3).ravel(), np.array(rgba, np.float32))
        self._scene.ngeom += 1
        return geom
