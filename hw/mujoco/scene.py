"""The whole scene: robot, terrain, physics settings."""

from __future__ import annotations

from collections.abc import Callable

import mujoco

from surefoot.config.deployment import Deployment
from surefoot.config.robot import GRAVITY, Robot
from surefoot.hw.mujoco.robot_body import add_robot
from surefoot.hw.mujoco.terrain import Field, add_terrain

PHYSICS_DT = 0.001
"""Step of the physics and of the motor law [s]."""

_CLEAR_M = 2.0
_SOLIMP = (0.95, 0.99, 0.001, 0.5, 2.0)


def build_scene(
    deployment: Deployment,
    robot: Robot | None,
    friction: float,
    extra: Callable[[mujoco.MjSpec], None] | None = None,
) -> tuple[mujoco.MjModel, Field]:
    """Compile the deployment's terrain and, if given, the robot on it.

    Args:
        deployment: terrain and contact settings.
        robot: figures of the plant (varied or nominal), or None for the terrain alone.
        friction: sliding friction coefficient of every contact.
        extra: adds bodies after the terrain.
    """
    spec = mujoco.MjSpec()
    spec.modelname = "surefoot"
    spec.compiler.degree = False  # joint ranges are radians
    spec.option.timestep = PHYSICS_DT
    spec.option.gravity = [0.0, 0.0, -GRAVITY]
    spec.option.integrator = mujoco.mjtIntegrator.mjINT_IMPLICITFAST
    spec.option.cone = mujoco.mjtCone.mjCONE_ELLIPTIC
    spec.option.impratio = 10.0
    spec.visual.global_.offwidth, spec.visual.global_.offheight = 1280, 960
    spec.add_texture(
        name="sky",
        type=mujoco.mjtTexture.mjTEXTURE_SKYBOX,
        builtin=mujoco.mjtBuiltin.mjBUILTIN_GRADIENT,
        rgb1=[0.75, 0.82, 0.90],
        rgb2=[0.95, 0.96, 0.97],
        width=64,
        height=384,
    )
    spec.visual.headlight.ambient, spec.visual.headlight.diffuse = [0.45] * 3, [0.45] * 3
    spec.worldbody.add_light(pos=[0.5, -1.0, 3.0], dir=[0.0, 0.3, -1.0], castshadow=False)
    if robot is not None:
        add_robot(spec, robot)
        spec.add_sensor(
            name="acc", type=mujoco.mjtSensor.mjSENS_ACCELEROMETER, objtype=mujoco.mjtObj.mjOBJ_SITE, objname="imu"
        )
        spec.add_sensor(
            name="gyro", type=mujoco.mjtSensor.mjSENS_GYRO, objtype=mujoco.mjtObj.mjOBJ_SITE, objname="imu"
        )
    field = add_terrain(spec, deployment.terrain, robot or deployment.load_robot(), deployment.hw.seed)
    if extra is not None:
        extra(spec)
    if spec.option.enableflags & mujoco.mjtEnableBit.mjENBL_SLEEP:
        _keep_awake(spec)
    for geom in spec.geoms:
        geom.friction = [friction, 0.005, 0.0001]
        geom.solref = [deployment.hw.solref_s, 1.0]
        geom.solimp = _SOLIMP
    return spec.compile(), field


def _keep_awake(spec: mujoco.MjSpec) -> None:
    """Nothing rests but what the terrain lets rest: not the robot, nor what stands in its way."""
    for body in spec.worldbody.bodies:
        if body.sleep == mujoco.mjtSleepPolicy.mjSLEEP_AUTO:
            body.sleep = mujoco.mjtSleepPolicy.mjSLEEP_NEVER
            if body.joints and body.joints[0].type == mujoco.mjtJoint.mjJNT_FREE:
                # Until it is put in its place it must not touch, and so wake, what begins asleep.
                body.pos = [0.0, 0.0, _CLEAR_M]
