"""A robot as URDF, from the figures that every model here is made of.

URDF has no rotor inertia: with it left out, mass matrices differ by `Joint.armature` on their diagonal. The file
says it in a comment at each joint.
"""

from __future__ import annotations

from collections.abc import Sequence
from xml.etree import ElementTree as xml

import numpy as np

from surefoot.config.robot import JOINTS, LEGS, Joint, Leg, Link, Primitive, Robot

_QUARTER = f"{np.pi / 2!r} 0 0"  # turns a cylinder from z, where URDF has its axis, to y


def urdf(robot: Robot) -> str:
    """The description as text: link `trunk`, and for each leg `FL_hip`, `FL_thigh`, `FL_calf`, `FL_foot`.

    Joints have the names of the links that they move; at zero they are as in `robot_model`.
    """
    root = xml.Element("robot", name=robot.name)
    trunk = _link(root, "trunk", robot.trunk)
    _shape(trunk, robot.collision["trunk"], side=1.0)
    for name in LEGS:
        _add_leg(root, name, robot.legs[name], robot)
    xml.indent(root)
    return '<?xml version="1.0"?>\n' + xml.tostring(root, encoding="unicode") + "\n"


def _add_leg(root: xml.Element, name: str, leg: Leg, robot: Robot) -> None:
    parent, side = "trunk", float(np.sign(leg.thigh_p_hip[1]))
    offsets = (leg.hip_p_B, leg.thigh_p_hip, (0.0, 0.0, -robot.thigh_length))
    for part, offset in zip(JOINTS, offsets, strict=True):
        child = f"{name}_{part}"
        link = _link(root, child, getattr(leg, part))
        _shape(link, robot.collision[part], side)
        _add_joint(root, child, parent, offset, robot.joints[part], getattr(leg, f"{part}_range"))
        parent = child
    foot = xml.SubElement(root, "link", name=f"{name}_foot")
    for kind in ("visual", "collision"):
        geometry = xml.SubElement(xml.SubElement(foot, kind), "geometry")
        xml.SubElement(geometry, "sphere", radius=repr(robot.foot.radius))
    fixed = xml.SubElement(root, "joint", name=f"{name}_foot_fixed", type="fixed")
    xml.SubElement(fixed, "parent", link=parent)
    xml.SubElement(fixed, "child", link=f"{name}_foot")
    xml.SubElement(fixed, "origin", xyz=_text((0.0, 0.0, -robot.calf_length)), rpy="0 0 0")


def _link(root: xml.Element, name: str, figures: Link) -> xml.Element:
    link = xml.SubElement(root, "link", name=name)
    inertial = xml.SubElement(link, "inertial")
    xml.SubElement(inertial, "origin", xyz=_text(figures.com), rpy="0 0 0")
    xml.SubElement(inertial, "mass", value=repr(figures.mass))
    names = ("ixx", "ixy", "ixz", "iyy", "iyz", "izz")
    moments = {name: repr(value) for name, value in zip(names, figures.inertia, strict=True)}
    xml.SubElement(inertial, "inertia", moments)
    return link


def _shape(link: xml.Element, shape: Primitive, side: float) -> None:
    x, y, z = shape.center
    for kind in ("visual", "collision"):
        element = xml.SubElement(link, kind)
        turn = "0 0 0" if shape.shape == "box" else _QUARTER
        xml.SubElement(element, "origin", xyz=_text((x, side * y, z)), rpy=turn)
        geometry = xml.SubElement(element, "geometry")
        if shape.shape == "box":
            xml.SubElement(geometry, "box", size=_text(shape.size))
        else:
            radius, length = shape.size
            xml.SubElement(geometry, "cylinder", radius=repr(radius), length=repr(length))


def _add_joint(
    root: xml.Element, name: str, parent: str, offset: Sequence[float], joint: Joint, turns: tuple[float, float]
) -> None:
    element = xml.SubElement(root, "joint", name=name, type="revolute")
    element.append(xml.Comment(f" rotor inertia, as the joint feels it: {joint.armature!r} kg m^2 "))
    xml.SubElement(element, "parent", link=parent)
    xml.SubElement(element, "child", link=name)
    xml.SubElement(element, "origin", xyz=_text(offset), rpy="0 0 0")
    xml.SubElement(element, "axis", xyz=_text(joint.axis))
    lower, upper = turns
    limits = {"lower": lower, "upper": upper, "effort": joint.torque_limit, "velocity": joint.velocity_limit}
    xml.SubElement(element, "limit", {key: repr(value) for key, value in limits.items()})
    xml.SubElement(element, "dynamics", damping=repr(joint.damping), friction=repr(joint.friction))


def _text(values: Sequence[float]) -> str:
    return " ".join(repr(float(value)) for value in values)
