"""What an Aliengo tells about itself in one packet."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from surefoot.hw.aliengo.remote import Remote


@dataclass(frozen=True, eq=False)
class AliengoState:
    """One state packet in our units and orders: joints of FL, FR, RL, RR; quaternions (w, x, y, z)."""

    quat_WB: np.ndarray  # (4,) the robot's own estimate; drifts under acceleration
    omega_WB_B: np.ndarray  # (3,) gyroscope [rad/s]
    acc_B: np.ndarray  # (3,) specific force, +g upwards at rest [m/s^2]
    rpy: np.ndarray  # (3,) roll, pitch, yaw of the same estimate [rad]
    imu_temperature: float  # [deg C]
    mode: np.ndarray  # (12,) integers: what each motor says it does; 10 is servo
    q: np.ndarray  # (12,) joint angles [rad]
    dq: np.ndarray  # (12,) joint velocities [rad/s]
    ddq: np.ndarray | None  # (12,) joint accelerations as told, unit not documented; None in generation G0
    tau: np.ndarray  # (12,) motor torque estimates [N m]
    temperature: np.ndarray  # (12,) of the motors, slow [deg C]
    foot_force: np.ndarray  # (4,) raw, of feet FL, FR, RL, RR: unit and zero are not documented
    tick: int  # the robot's clock, 32 bits, wraps; microseconds or milliseconds
    remote: Remote  # what is held on the wireless remote
