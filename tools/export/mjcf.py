"""A robot as MJCF: the bodies of the simulator, with motors, on a floor."""

from __future__ import annotations

import mujoco
import numpy as np

from surefoot.config.robot import GRAVITY, JOINT_NAMES, LEGS, Robot
from surefoot.hw.mujoco.robot_body import TERRAIN_BITS, add_robot
from surefoot.hw.mujoco.scene import PHYSICS_DT

STAND = "stand"
"""Name of the keyframe in which it stands on the floor."""


def mjcf(robot: Robot) -> str:
    """The description as text; `mujoco.MjModel.from_xml_string` reads it.

    Joints and motors come in the order of the legs; a motor's control is its torque [N m].
    """
    spec = mujoco.MjSpec()
    spec.modelname = robot.name
    spec.compiler.degree = False
    spec.option.timestep = PHYSICS_DT
    spec.option.gravity = [0.0, 0.0, -GRAVITY]
    spec.option.integrator = mujoco.mjtIntegrator.mjINT_IMPLICITFAST
    spec.worldbody.add_light(pos=[0.0, 0.0, 3.0], dir=[0.0, 0.0, -1.0])
    spec.worldbody.add_geom(name="floor", type=mujoco.mjtGeom.mjGEOM_PLANE, size=[20.0, 20.0, 0.1], **TERRAIN_BITS)
    add_robot(spec, robot)
    for name, limit in zip(JOINT_NAMES, robot.per_joint("torque_limit"), strict=True):
        motor = spec.add_actuator(name=name, target=name, trntype=mujoco.mjtTrn.mjTRN_JOINT)
        motor.set_to_motor()
        motor.ctrlrange, motor.ctrllimited = [-limit, limit], mujoco.mjtLimited.mjLIMITED_TRUE
    height = robot.nominal.leg_height - robot.legs["FL"].hip_p_B[2]
    posture = np.tile(robot.nominal.stand_q, len(LEGS))
    spec.add_key(name=STAND, qpos=[0.0, 0.0, height, 1.0, 0.0, 0.0, 0.0, *posture])
    spec.compile()
    return spec.to_xml()
