"""How the simulated robot differs from its model: drawn once from the seed."""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np

from surefoot.config.hw import Hw
from surefoot.config.robot import Robot

_STREAMS = (
    "trunk_mass",
    "com",
    "friction",
    "gyro_bias",
    "acc_bias",
    "q",
    "dq",
    "tau",
    "gyro",
    "acc",
    "depth_noise",
    "depth_dropout",
    "missing",
    "slope",
    "rocks",
    "tiles",
    "foam",
    "edge",
    "trap",
    "link_commands",
    "link_states",
)
"""A stream is its place in here: new ones come last."""


def stream(seed: int, name: str) -> np.random.Generator:
    """The random stream of one quantity: changing one setting never shifts the noise of another."""
    return np.random.default_rng([seed, _STREAMS.index(name)])


@dataclass(frozen=True)
class Plant:
    """The true robot and ground of one run."""

    robot: Robot
    friction: float  # sliding friction coefficient of every contact
    gyro_bias: np.ndarray  # (3,) [rad/s]
    acc_bias: np.ndarray  # (3,) [m/s^2]


def draw_plant(robot: Robot, settings: Hw) -> Plant:
    """Vary mass, centre of mass and friction, and draw the sensors' biases, from `settings.seed`."""

    def rng(name: str) -> np.random.Generator:
        return stream(settings.seed, name)

    trunk = robot.trunk
    scale = 1.0 + settings.trunk_mass_error * rng("trunk_mass").uniform(-1.0, 1.0)
    offset = settings.com_error_m * rng("com").uniform(-1.0, 1.0, 3)
    ixx, ixy, ixz, iyy, iyz, izz = (scale * figure for figure in trunk.inertia)
    varied = replace(
        trunk,
        mass=trunk.mass * scale,
        com=tuple(np.array(trunk.com) + offset),
        inertia=(ixx, ixy, ixz, iyy, iyz, izz),
    )
    return Plant(
        robot=replace(robot, trunk=varied),
        friction=float(rng("friction").uniform(settings.friction_min, settings.friction_max)),
        gyro_bias=settings.gyro_bias * rng("gyro_bias").normal(size=3),
        acc_bias=settings.acc_bias * rng("acc_bias").normal(size=3),
    )
