"""The truth about the ground: what a foot-sized sphere does when it presses with an asked force."""

from __future__ import annotations

from dataclasses import dataclass

import mujoco
import numpy as np

from surefoot.config.deployment import Deployment
from surefoot.config.robot import GRAVITY
from surefoot.hw.mujoco.robot_body import ROBOT_BITS
from surefoot.hw.mujoco.scene import PHYSICS_DT, build_scene

COLLAPSE_M = 0.03
"""Displacement that counts as collapse (Sec. II-D.5)."""

_PRESS_S = 0.100
_SPHERE_MASS = 0.5  # light against the force, heavy enough for a stable contact [kg]
_REST_S = 0.05  # the sphere settles on the surface before the press


@dataclass(frozen=True)
class Press:
    """What one press did."""

    displacement_m: float  # largest distance of the sphere from where it rested

    @property
    def collapsible(self) -> bool:
        """Whether the ground gives way at that load."""
        return self.displacement_m > COLLAPSE_M


class PressTest:
    """Presses points of a deployment's terrain, in a scene without the robot."""

    def __init__(self, deployment: Deployment, friction: float = 0.6):
        robot = deployment.load_robot()
        self._radius = robot.foot.radius
        self._model = self._with_sphere(deployment, friction)
        self._data = mujoco.MjData(self._model)

    def press(self, x: float, y: float, force_n: float) -> Press:
        """Press at (x, y) of the world with a normal force [N] for 100 ms."""
        model, data = self._model, self._data
        mujoco.mj_resetData(model, data)
        data.qpos[-3:] = [x, y, self._radius]
        weight = _SPHERE_MASS * GRAVITY
        data.qfrc_applied[-1] = weight - 1.0  # rests with one newton
        for _ in range(round(_REST_S / PHYSICS_DT)):
            mujoco.mj_step(model, data)
        start, largest = data.qpos[-3:].copy(), 0.0
        data.qfrc_applied[-1] = weight - force_n
        for _ in range(round(_PRESS_S / PHYSICS_DT)):
            mujoco.mj_step(model, data)
            largest = max(largest, float(np.linalg.norm(data.qpos[-3:] - start)))
        return Press(largest)

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
