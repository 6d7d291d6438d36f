"""Settings of the hardware layer: which backend, and how the simulated plant differs from its model."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Literal


@dataclass(frozen=True)
class Hw:
    """Backend and simulated plant. The seed draws every random figure."""

    backend: Literal["mujoco"] = "mujoco"
    seed: int = 0
    start: Literal["standing", "lying"] = "standing"
    command_delay_s: float = 0.004  # from command to motor
    torque_noise: float = 0.5  # standard deviation of the torque estimate [N m]
    encoder_noise: float = 1e-3  # of joint angles [rad]
    velocity_noise: float = 0.02  # of joint velocities [rad/s]
    gyro_noise: float = 0.005  # white, per sample [rad/s]
    gyro_bias: float = 0.005  # standard deviation of the constant bias [rad/s]
    acc_noise: float = 0.05  # white, per sample [m/s^2]
    acc_bias: float = 0.05  # standard deviation of the constant bias [m/s^2]
    trunk_mass_error: float = 0.05  # uniform +- share of the trunk's mass
    com_error_m: float = 0.01  # uniform +- offset of the trunk's centre of mass, per axis
    friction_min: float = 0.4  # coefficient of the ground, uniform between the two
    friction_max: float = 0.8
    command_timeout_s: float = 0.050  # older commands damp
    damping_kd: float = 3.0  # joint damping of the safe state [N m s/rad]
    kp_max: float = 500.0  # larger position gains are refused [N m/rad]
    kd_max: float = 20.0  # larger velocity gains are refused [N m s/rad]
    solref_s: float = 0.005  # time constant of contacts; soft defaults sink millimetres [s]
