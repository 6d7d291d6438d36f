"""Pinocchio's model of a robot, built from its figures.

Configuration q (19): base position in the world, base quaternion (x, y, z, w), twelve joints.
Velocity v (18): base linear and angular velocity in the base frame, twelve joints. Legs FL, FR, RL, RR.
"""

from __future__ import annotations

import numpy as np
import pinocchio as pin

from surefoot.config.robot import GRAVITY, JOINTS, LEGS, Joint, Link, Robot


def build_model(robot: Robot) -> pin.Model:
    """Floating-base model with one frame at each foot's centre, named `FL_foot`, ...

    Rotor inertia is the model's armature, so that `pin.crba` includes it.
    """
    model = pin.Model()
    model.name = robot.name
    model.gravity.linear = np.array([0.0, 0.0, -GRAVITY])
    base = model.addJoint(0, pin.JointModelFreeFlyer(), pin.SE3.Identity(), "base")
    model.appendBodyToJoint(base, _inertia(robot.trunk), pin.SE3.Identity())
    for name in LEGS:
        leg = robot.legs[name]
        parent = base
        offsets = (leg.hip_p_B, leg.thigh_p_hip, (0.0, 0.0, -robot.thigh_length))
        for joint_name, offset in zip(JOINTS, offsets, strict=True):
            joint = robot.joints[joint_name]
            lower, upper = getattr(leg, f"{joint_name}_range")
            parent = model.addJoint(
                parent,
                _revolute(joint),
                pin.SE3(np.eye(3), np.array(offset)),
                f"{name}_{joint_name}",
                np.array([joint.torque_limit]),
                np.array([joint.velocity_limit]),
                np.array([lower]),
                np.array([upper]),
            )
            model.appendBodyToJoint(parent, _inertia(getattr(leg, joint_name)), pin.SE3.Identity())
        foot = pin.SE3(np.eye(3), np.array([0.0, 0.0, -robot.calf_length]))
        model.addFrame(pin.Frame(f"{name}_foot", parent, foot, pin.FrameType.OP_FRAME))
    model.armature = np.concatenate([np.zeros(6), robot.per_joint("armature")])
    return model


def foot_frame_ids(model: pin.Model) -> tuple[int, ...]:
    """Frame index of the four feet, legs in order."""
    return tuple(model.getFrameId(f"{leg}_foot") for leg in LEGS)


def _inertia(link: Link) -> pin.Inertia:
    ixx, ixy, ixz, iyy, iyz, izz = link.inertia
    matrix = np.array([[ixx, ixy, ixz], [ixy, iyy, iyz], [ixz, iyz, izz]])
    return pin.Inertia(link.mass, np.array(link.com), matrix)


def _revolute(joint: Joint):
    kinds = {(1.0, 0.0, 0.0): pin.JointModelRX, (0.0, 1.0, 0.0): pin.JointModelRY}
    if joint.axis in kinds:
        return kinds[joint.axis]()
    return pin.JointModelRevoluteUnaligned(np.array(joint.axis))
