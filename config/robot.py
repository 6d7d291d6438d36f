"""A robot's figures: the one source of the Pinocchio model, the MuJoCo model and every limit."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path
from typing import Literal

from surefoot.config.typed_toml import ConfigError, build, read_toml

LEGS = ("FL", "FR", "RL", "RR")
"""Order of legs in every array: front left, front right, rear left, rear right."""

JOINTS = ("hip", "thigh", "calf")
"""Order of joints in a leg: abduction, thigh, calf."""

JOINT_NAMES = tuple(f"{leg}_{joint}" for leg in LEGS for joint in JOINTS)

GRAVITY = 9.81
"""Magnitude of gravity [m/s^2]; acts along -z of the world."""

Vector = tuple[float, float, float]


@dataclass(frozen=True)
class Link:
    """Inertial figures of one rigid body, in its own frame."""

    mass: float  # [kg]
    com: Vector  # centre of mass [m]
    inertia: tuple[float, float, float, float, float, float]  # ixx ixy ixz iyy iyz izz about the com [kg m^2]

    def __post_init__(self) -> None:
        if self.mass <= 0.0:
            raise ConfigError(f"mass = {self.mass}: a body's mass must be positive")


@dataclass(frozen=True)
class Joint:
    """What a joint of one type has in common on all legs."""

    axis: Vector
    armature: float  # reflected rotor inertia [kg m^2]
    friction: float  # Coulomb friction [N m]
    damping: float  # viscous friction [N m s/rad]
    torque_limit: float  # [N m]
    velocity_limit: float  # [rad/s]


@dataclass(frozen=True)
class Leg:
    """One leg: where its axes are, how far they turn, what its links weigh."""

    hip_p_B: Vector  # abduction axis in the trunk frame [m]
    thigh_p_hip: Vector  # thigh axis in the hip frame [m]
    hip_range: tuple[float, float]  # [rad]
    thigh_range: tuple[float, float]
    calf_range: tuple[float, float]
    hip: Link
    thigh: Link
    calf: Link


@dataclass(frozen=True)
class Foot:
    radius: float  # [m]


@dataclass(frozen=True)
class Nominal:
    """Postures the planner starts from."""

    leg_height: float  # hip axes above the ground when standing [m]
    stand_q: Vector  # hip, thigh, calf [rad]
    lie_q: Vector


@dataclass(frozen=True)
class Imu:
    p_B: Vector  # in the trunk frame [m]


@dataclass(frozen=True)
class Primitive:
    """A collision shape in its link's frame."""

    shape: Literal["box", "cylinder_y"]
    size: tuple[float, ...]  # box: full lengths; cylinder_y: radius, length [m]
    center: Vector  # [m]; y is outward and mirrored on right legs


@dataclass(frozen=True)
class Robot:
    """All figures of one robot."""

    name: str
    thigh_length: float  # [m]
    calf_length: float  # [m]
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

    @property
    def mass(self) -> float:
        """Total mass [kg]."""
        return self.trunk.mass + sum(getattr(leg, part).mass for leg in self.legs.values() for part in JOINTS)

    def per_joint(self, figure: str) -> tuple[float, ...]:
        """A figure of `Joint` for the twelve joints in order, e.g. `per_joint("torque_limit")`."""
        return tuple(getattr(self.joints[joint], figure) for _ in LEGS for joint in JOINTS)

    def position_range(self) -> tuple[tuple[float, float], ...]:
        """(lower, upper) of the twelve joints [rad]."""
        return tuple(getattr(self.legs[leg], f"{joint}_range") for leg in LEGS for joint in JOINTS)


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
