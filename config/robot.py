"""A robot's figures: the one source of the Pinocchio model, the MuJoCo model and every limit."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cache
from math import cos, hypot, sqrt
from pathlib import Path
from typing import Annotated, Literal

from surefoot.config.typed_toml import ConfigError, Within, build, read_toml

LEGS = ("FL", "FR", "RL", "RR")
"""Order of legs in every array: front left, front right, rear left, rear right."""

ANTICLOCKWISE = (0, 2, 3, 1)
"""The legs around the robot: three of them in this order enclose their triangle anticlockwise."""

JOINTS = ("hip", "thigh", "calf")
"""Order of joints in a leg: abduction, thigh, calf."""

JOINT_NAMES = tuple(f"{leg}_{joint}" for leg in LEGS for joint in JOINTS)

GRAVITY = 9.81
"""Magnitude of gravity [m/s^2]; acts along -z of the world."""

Coordinate = Annotated[float, Within(-2.0, 2.0)]
Length = Annotated[float, Within(0.001, 2.0)]
Mass = Annotated[float, Within(1e-3, 200.0)]
Moment = Annotated[float, Within(1e-9, 100.0)]
Product = Annotated[float, Within(-100.0, 100.0)]
Cosine = Annotated[float, Within(-1.0, 1.0)]
Loss = Annotated[float, Within(0.0, 20.0)]
Angle = Annotated[float, Within(-6.3, 6.3)]
Bend = Annotated[float, Within(-3.14, -0.01)]  # of a calf: knees bend backwards, and a straight leg is singular
Vector = tuple[Coordinate, Coordinate, Coordinate]
Inertia = tuple[Moment, Product, Product, Moment, Product, Moment]
Axis = tuple[Cosine, Cosine, Cosine]
Posture = tuple[Angle, Angle, Bend]
Range = tuple[Angle, Angle]


@dataclass(frozen=True)
class Link:
    """Inertial figures of one rigid body, in its own frame."""

    mass: Mass  # [kg]
    com: Vector  # centre of mass [m]
    inertia: Inertia  # ixx ixy ixz iyy iyz izz about the com [kg m^2]

    def __post_init__(self) -> None:
        ixx, ixy, ixz, iyy, iyz, izz = self.inertia
        minor = ixx * iyy - ixy * ixy
        whole = minor * izz - ixx * iyz * iyz - iyy * ixz * ixz + 2.0 * ixy * ixz * iyz
        if min(minor, whole) <= 0.0:
            raise ConfigError(
                f"inertia = {list(self.inertia)}: no body turns so, the matrix is not positive definite; "
                "the order is ixx, ixy, ixz, iyy, iyz, izz"
            )


@dataclass(frozen=True)
class Joint:
    """What a joint of one type has in common on all legs."""

    axis: Axis  # unit vector
    armature: Annotated[float, Within(0.0, 1.0)]  # reflected rotor inertia [kg m^2]
    friction: Loss  # Coulomb friction [N m]
    damping: Loss  # viscous friction [N m s/rad]
    torque_limit: Annotated[float, Within(0.1, 1000.0)]  # [N m]
    velocity_limit: Annotated[float, Within(0.1, 200.0)]  # [rad/s]

    def __post_init__(self) -> None:
        if abs(hypot(*self.axis) - 1.0) > 1e-6:
            raise ConfigError(f"axis = {list(self.axis)}: of length {hypot(*self.axis):g}, must be 1")


@dataclass(frozen=True)
class Leg:
    """One leg: where its axes are, how far they turn, what its links weigh."""

    hip_p_B: Vector  # abduction axis in the trunk frame [m]
    thigh_p_hip: Vector  # thigh axis in the hip frame [m]
    hip_range: Range  # [rad]
    thigh_range: Range
    calf_range: tuple[Bend, Bend]
    hip: Link
    thigh: Link
    calf: Link

    def __post_init__(self) -> None:
        for joint in JOINTS:
            lower, upper = getattr(self, f"{joint}_range")
            if lower >= upper:
                raise ConfigError(f"{joint}_range = {[lower, upper]}: the lower limit comes first")


@dataclass(frozen=True)
class Foot:
    radius: Length  # [m]


@dataclass(frozen=True)
class Nominal:
    """Postures the planner starts from."""

    leg_height: Length  # hip axes above the ground when standing [m]
    stand_q: Posture  # hip, thigh, calf [rad]
    lie_q: Posture


@dataclass(frozen=True)
class Imu:
    p_B: Vector  # in the trunk frame [m]


@dataclass(frozen=True)
class Primitive:
    """A collision shape in its link's frame."""

    shape: Literal["box", "cylinder_y"]
    size: tuple[Length, ...]  # box: full lengths; cylinder_y: radius, length [m]
    center: Vector  # [m]; y is outward and mirrored on right legs

    def __post_init__(self) -> None:
        names = {"box": ("x", "y", "z"), "cylinder_y": ("radius", "length")}[self.shape]
        if len(self.size) != len(names):
            raise ConfigError(f"size = {list(self.size)}: a {self.shape} has {len(names)}: {', '.join(names)}")


@dataclass(frozen=True)
class Robot:
    """All figures of one robot."""

    name: str
    thigh_length: Length  # [m]
    calf_length: Length  # [m]
    foot: Foot
    nominal: Nominal
    joints: dict[str, Joint]
    imu: Imu
    collision: dict[str, Primitive]
    trunk: Link
    legs: dict[str, Leg]

    def __post_init__(self) -> None:
        _require("joints", self.joints, JOINTS)
        _require("legs", self.legs, LEGS)
        _require("collision", self.collision, ("trunk", *JOINTS))
        for posture in ("stand_q", "lie_q"):
            self._check_posture(posture)

    @property
    def mass(self) -> float:
        """Total mass [kg]."""
        return self.trunk.mass + sum(getattr(leg, part).mass for leg in self.legs.values() for part in JOINTS)

    @property
    def reach(self) -> float:
        """Longest distance from thigh axis to foot centre that every calf's range allows [m]."""
        bend = min(leg.calf_range[1] for leg in self.legs.values())
        thigh, calf = self.thigh_length, self.calf_length
        return sqrt(thigh * thigh + calf * calf + 2.0 * thigh * calf * cos(bend))

    def per_joint(self, figure: str) -> tuple[float, ...]:
        """A figure of `Joint` for the twelve joints in order, e.g. `per_joint("torque_limit")`."""
        return tuple(getattr(self.joints[joint], figure) for _ in LEGS for joint in JOINTS)

    def position_range(self) -> tuple[tuple[float, float], ...]:
        """(lower, upper) of the twelve joints [rad]."""
        return tuple(getattr(self.legs[leg], f"{joint}_range") for leg in LEGS for joint in JOINTS)

    def _check_posture(self, posture: str) -> None:
        for name, leg in self.legs.items():
            for joint, angle in zip(JOINTS, getattr(self.nominal, posture), strict=True):
                lower, upper = getattr(leg, f"{joint}_range")
                if not lower <= angle <= upper:
                    raise ConfigError(
                        f"nominal.{posture}: {joint} at {angle} rad is outside legs.{name}.{joint}_range = "
                        f"{[lower, upper]}"
                    )


@cache
def load_robot(name: str) -> Robot:
    """The robot described by `config/robots/NAME.toml`.

    Raises:
        ConfigError: no such robot, an unknown leg or joint, or a missing figure, each by its path.
    """
    path = Path(__file__).parent / "robots" / f"{name}.toml"
    if not path.is_file():
        known = sorted(p.stem for p in path.parent.glob("*.toml"))
        raise ConfigError(f"robot {name!r} is not described; known: {', '.join(known)}")
    return build(Robot, read_toml(path), f"robots/{name}")


def _require(what: str, table: dict, names: tuple[str, ...]) -> None:
    for name in names:
        if name not in table:
            raise ConfigError(f"{what}.{name}: missing; {what} must hold {', '.join(names)}")
    for name in table:
        if name not in names:
            raise ConfigError(f"{what}.{name}: unknown name; {what} holds {', '.join(names)}")
