"""The truth about the ground: what a foot-sized sphere does when it presses with an asked force."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import mujoco
import numpy as np

from surefoot.config.deployment import Deployment
from surefoot.config.robot import GRAVITY
from surefoot.hw.mujoco.robot_body import ROBOT_BITS
from surefoot.hw.mujoco.scene import PHYSICS_DT, build_scene

COLLAPSE_M = 0.03
"""Displacement that counts as collapse (Sec. II-D.5)."""

_RISE_S = 0.100  # the force grows this slowly: at once, the momentum of what gives way breaks its neighbour too
_PRESS_S = 0.100
_SPHERE_MASS = 0.5  # light against the force, heavy enough for a stable contact [kg]
_REST_S = 0.05  # the sphere settles on the surface before the press
_SKY_M = 5.0  # above every terrain
_FREE_M = 1e-5  # what is nearer to touching than this touches
_LIFTS = 40


@dataclass(frozen=True)
class Press:
    """What one press did."""

    displacement_m: float  # largest distance of the sphere from where it rested

    @property
    def collapsible(self) -> bool:
        """Whether the ground gives way at that load."""
        return self.displacement_m > COLLAPSE_M


class PressTest:
    """Presses points of a deployment's terrain, in a scene without the robot.

    Every press finds the terrain as it is at the start of a run.
    """

    def __init__(self, deployment: Deployment, friction: float = 0.6):
        robot = deployment.load_robot()
        self._radius = robot.foot.radius
        self._model = self._with_sphere(deployment, friction)
        self._data = mujoco.MjData(self._model)
        self._body = self._model.body("press").id
        self._geom = self._model.geom("press").id
        self._feelers, self._heights = _underside(self._radius)

    def press(self, x: float, y: float, force_n: float) -> Press:
        """Press down at (x, y) of the world with a force [N] for 100 ms, once it has grown to that.

        Raises:
            ValueError: there is no ground.
        """
        model, data = self._model, self._data
        mujoco.mj_resetData(model, data)
        data.qpos[-3:] = [x, y, self._lowered(x, y)]
        weight = _SPHERE_MASS * GRAVITY
        data.qfrc_applied[-1] = weight - 1.0  # rests with one newton
        for _ in range(round(_REST_S / PHYSICS_DT)):
            mujoco.mj_step(model, data)
        start, largest = data.qpos[-3:].copy(), 0.0
        rise = round(_RISE_S / PHYSICS_DT)
        for step in range(rise + round(_PRESS_S / PHYSICS_DT)):
            share = min(1.0, (step + 1) / rise)
            data.qfrc_applied[-1] = weight - 1.0 - share * (force_n - 1.0)
            mujoco.mj_step(model, data)
            largest = max(largest, float(np.linalg.norm(data.qpos[-3:] - start)))
        return Press(largest)

    def label_map(self, xs: Sequence[float], ys: Sequence[float], force_n: float) -> np.ndarray:
        """(len(xs), len(ys)) displacement under the same force at every point of a grid [m]."""
        return np.array([[self.press(x, y, force_n).displacement_m for y in ys] for x in xs])

    def surface(self, x: float, y: float) -> float:
        """Height of the terrain's surface under a point [m].

        Raises:
            ValueError: there is no ground.
        """
        mujoco.mj_resetData(self._model, self._data)
        return float(self._below(np.array([[x, y, _SKY_M]]))[0])

    def _below(self, points: np.ndarray) -> np.ndarray:
        """(n,) heights of the surface under (n, 3) points."""
        model, data = self._model, self._data
        mujoco.mj_kinematics(model, data)
        down, hit, normal = np.array([0.0, 0.0, -1.0]), np.zeros(1, np.int32), np.zeros(3)
        heights = np.empty(len(points))
        for index, point in enumerate(points):
            distance = mujoco.mj_ray(model, data, point, down, None, 1, self._body, hit, normal)
            if distance < 0.0:
                raise ValueError(
                    f"no ground under x = {point[0]:g} m, y = {point[1]:g} m; press where there is some"
                )
            heights[index] = point[2] - distance
        return heights

    def _lowered(self, x: float, y: float) -> float:
        """Height at which the sphere, let down at (x, y), first touches."""
        model, data = self._model, self._data
        z = float((self._below([x, y, _SKY_M] + self._feelers) + self._heights).max())
        # Between the feelers something may stand higher.
        for _ in range(_LIFTS):
            data.qpos[-3:] = [x, y, z]
            mujoco.mj_kinematics(model, data)
            mujoco.mj_collision(model, data)
            mine = (data.contact.geom == self._geom).any(axis=1)
            depth = -float(data.contact.dist[mine].min(initial=0.0))
            if depth < _FREE_M:
                break
            z += depth
        return z

    def _with_sphere(self, deployment: Deployment, friction: float) -> mujoco.MjModel:
        def add_sphere(spec: mujoco.MjSpec) -> None:
            # Slides along x, y, z and does not roll, as a foot on a leg.
            body = spec.worldbody.add_body(name="press")
            for axis, direction in enumerate(np.eye(3)):
                body.add_joint(name=f"press_{axis}", type=mujoco.mjtJoint.mjJNT_SLIDE, axis=direction)
            body.add_geom(
                name="press",
                type=mujoco.mjtGeom.mjGEOM_SPHERE,
                size=[self._radius, 0.0, 0.0],
                mass=_SPHERE_MASS,
                **ROBOT_BITS,
            )

        model, _ = build_scene(deployment, None, friction, extra=add_sphere)
        # Held sideways by the leg: stiff damping keeps the point where it presses.
        model.dof_damping[-3:-1] = 500.0
        return model


def _underside(radius: float) -> tuple[np.ndarray, np.ndarray]:
    """(n, 3) horizontal offsets over a sphere's lower half, and how high its centre is above each."""
    offsets, heights = [np.zeros(3)], [radius]
    for share in (0.4, 0.7, 0.95):
        for angle in np.arange(8) * 0.25 * np.pi:
            offsets.append(share * radius * np.array([np.cos(angle), np.sin(angle), 0.0]))
            heights.append(radius * np.sqrt(1.0 - share**2))
    return np.array(offsets), np.array(heights)
