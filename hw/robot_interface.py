"""What every robot offers: read the sensors, write one motor law per joint.

A cycle in which nothing is written damps: a forgotten command can never keep pushing.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Literal, Protocol

import numpy as np

from surefoot.bus.messages import SimTruth

Stop = Literal["", "settle", "cut"]
"""What is asked for at the robot itself, as with a remote: nothing, to sit down and damp, or no torque at once."""


@dataclass(frozen=True)
class Sensors:
    """One reading of everything a real Aliengo can say; joints in order FL, FR, RL, RR."""

    q: np.ndarray  # (12,) joint angles [rad]
    dq: np.ndarray  # (12,) joint velocities [rad/s]
    tau: np.ndarray  # (12,) motor torque estimates [N m]
    omega_WB_B: np.ndarray  # (3,) gyroscope [rad/s]
    acc_B: np.ndarray  # (3,) specific force [m/s^2]
    t: float | None = None  # when it was measured, on this machine's monotonic clock [s]; None: `age_s` ago
    age_s: float = 0.0  # of a reading without a time, on a clock that waits for the robot [s]
    stop: Stop = ""  # what a person who is with the robot asks for now
    temperature: np.ndarray | None = None  # (12,) of the motors [deg C]; None: nobody measures it
    foot_force: np.ndarray | None = None  # (4,) of feet FL, FR, RL, RR, raw or by hw.unit; None without sensors


@dataclass(frozen=True)
class DepthImage:
    """One image of a depth camera; frame C has x along the optical axis, y left, z up in the image."""

    p_BC: np.ndarray  # (3,) camera in the trunk [m]
    quat_BC: np.ndarray  # (4,) (w, x, y, z)
    fov: np.ndarray  # (2,) horizontal, vertical [rad]
    depth_m: np.ndarray  # (rows, columns) float32 along the optical axis; 0 where there is none [m]


@dataclass(frozen=True)
class MotorLaw:
    """tau + kp (q - q_measured) + kd (dq - dq_measured), each (12,)."""

    q: np.ndarray  # [rad]
    dq: np.ndarray  # [rad/s]
    kp: np.ndarray  # [N m/rad]
    kd: np.ndarray  # [N m s/rad]
    tau: np.ndarray  # [N m]


def damping_law(kd: float) -> MotorLaw:
    """The safe state: every joint is braked, none is driven."""
    zero = np.zeros(12)
    return MotorLaw(q=zero, dq=zero, kp=zero, kd=np.full(12, kd), tau=zero)


class RobotInterface(Protocol):
    """A robot, simulated or real."""

    @property
    def trouble(self) -> str:
        """In words what is amiss though it goes on; empty when nothing is.

        With the last law, or with the link in the last `TOLD_S` seconds.
        """

    def read(self) -> Sensors:
        """The newest sensor values.

        Raises:
            HardwareFault: no plausible reading is to be had.
        """

    def depth(self) -> DepthImage | None:
        """The depth camera's image of this instant; None between images, without vision and without a camera."""

    def write(self, law: MotorLaw) -> None:
        """The motor law of this cycle."""

    def advance(self) -> None:
        """End the cycle: a simulator steps its physics, a driver waits for nothing. Unwritten cycles damp."""

    def truth(self) -> SimTruth | None:
        """What only a simulator knows, for logs and grading; None on a robot."""

    def close(self) -> None:
        """Leave the robot damping and free what is held."""
