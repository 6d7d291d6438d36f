"""The robot as MuJoCo bodies, from the same figures as Pinocchio's model."""

from __future__ import annotations

import mujoco
import numpy as np

from surefoot.config.robot import JOINTS, LEGS, Link, Primitive, Robot

ROBOT_BITS = {"contype": 1, "conaffinity": 2}
"""Collision bits of the robot: it meets the terrain, never itself."""

TERRAIN_BITS = {"contype": 2, "conaffinity": 1}
"""Collision bits of the terrain: it meets the robot and what is loose, never itself."""

LOOSE_BITS = {"contype": 4, "conaffinity": 7}
"""Collision bits of loose terrain: it meets the robot, the terrain and its own kind."""

_COLORS = {
    "trunk": (0.25, 0.27, 0.30, 1.0),
    "hip": (0.35, 0.37, 0.40, 1.0),
    "thigh": (0.85, 0.45, 0.15, 1.0),
    "calf": (0.30, 0.32, 0.35, 1.0),
}


def add_robot(spec: mujoco.MjSpec, robot: Robot) -> None:
    """Add the floating robot: joints `FL_hip`, ..., geoms `trunk`, `FL_foot`, ..., site `imu`.

    Bodies and joints come in the order of Pinocchio's model, so that the joint arrays agree.
    """
    trunk = spec.worldbody.add_body(name="trunk")
    trunk.add_freejoint(name="base")
    _set_inertia(trunk, robot.trunk)
    _add_primitive(trunk, "trunk", robot.collision["trunk"], "trunk", side=1.0)
    trunk.add_site(name="imu", pos=robot.imu.p_B)
    for name in LEGS:
        leg = robot.legs[name]
        side = float(np.sign(leg.thigh_p_hip[1]))
        parent = trunk
        offsets = (leg.hip_p_B, leg.thigh_p_hip, (0.0, 0.0, -robot.thigh_length))
        for joint_name, offset in zip(JOINTS, offsets, strict=True):
            joint = robot.joints[joint_name]
            parent = parent.add_body(name=f"{name}_{joint_name}", pos=offset)
            _set_inertia(parent, getattr(leg, joint_name))
            parent.add_joint(
                name=f"{name}_{joint_name}",
                type=mujoco.mjtJoint.mjJNT_HINGE,
                axis=joint.axis,
                limited=mujoco.mjtLimited.mjLIMITED_TRUE,
                range=getattr(leg, f"{joint_name}_range"),
                armature=joint.armature,
                damping=[joint.damping, 0.0, 0.0],
                frictionloss=joint.friction,
            )
            _add_primitive(parent, f"{name}_{joint_name}", robot.collision[joint_name], joint_name, side)
        parent.add_geom(
            name=f"{name}_foot",
            type=mujoco.mjtGeom.mjGEOM_SPHERE,
            size=[robot.foot.radius, 0.0, 0.0],
            pos=[0.0, 0.0, -robot.calf_length],
            mass=0.0,
            rgba=[0.1, 0.1, 0.1, 1.0],
            **ROBOT_BITS,
        )


def _set_inertia(body: mujoco.MjsBody, link: Link) -> None:
    ixx, ixy, ixz, iyy, iyz, izz = link.inertia
    body.explicitinertial = True
    body.mass = link.mass
    body.ipos = link.com
    body.fullinertia = [ixx, iyy, izz, ixy, ixz, iyz]


def _add_primitive(body: mujoco.MjsBody, name: str, shape: Primitive, kind: str, side: float) -> None:
    x, y, z = shape.center
    figures = {"name": name, "pos": [x, side * y, z], "mass": 0.0, "rgba": _COLORS[kind], **ROBOT_BITS}
    if shape.shape == "box":
        body.add_geom(type=mujoco.mjtGeom.mjGEOM_BOX, size=[0.5 * s for s in shape.size], **figures)
    else:
        radius, length = shape.size
        half = np.sqrt(0.5)
        body.add_geom(
            type=mujoco.mjtGeom.mjGEOM_CYLINDER,
            size=[radius, 0.5 * length, 0.0],
            quat=[half, half, 0.0, 0.0],
            **figures,
        )
