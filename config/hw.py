"""Settings of the hardware layer: which robot, its wire, how the simulated plant differs from its model."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import Annotated, Literal

from surefoot.config.aliengo import Aliengo
from surefoot.config.depth_camera import DepthCamera
from surefoot.config.gate import Gate
from surefoot.config.typed_toml import Within, ordered


@dataclass(frozen=True)
class Hw:
    """Backend and simulated plant. The seed draws every random figure."""

    backend: Literal["mujoco", "aliengo"] = "mujoco"
    seed: Annotated[int, Within(0, 2**31)] = 0
    start: Literal["standing", "lying"] = "standing"
    command_delay_s: Annotated[float, Within(0.0, 0.1)] = 0.004  # from command to motor
    torque_noise: Annotated[float, Within(0.0, 20.0)] = 0.5  # standard deviation of the torque estimate [N m]
    encoder_noise: Annotated[float, Within(0.0, 0.1)] = 1e-3  # of joint angles [rad]
    velocity_noise: Annotated[float, Within(0.0, 2.0)] = 0.02  # of joint velocities [rad/s]
    gyro_noise: Annotated[float, Within(0.0, 1.0)] = 0.005  # white, per sample [rad/s]
    gyro_bias: Annotated[float, Within(0.0, 1.0)] = 0.005  # standard deviation of the constant bias [rad/s]
    acc_noise: Annotated[float, Within(0.0, 10.0)] = 0.05  # white, per sample [m/s^2]
    acc_bias: Annotated[float, Within(0.0, 5.0)] = 0.05  # standard deviation of the constant bias [m/s^2]
    trunk_mass_error: Annotated[float, Within(0.0, 0.5)] = 0.05  # uniform +- share of the trunk's mass
    com_error_m: Annotated[float, Within(0.0, 0.1)] = (
        0.01  # uniform +- offset of the trunk's centre of mass, per axis
    )
    friction_min: Annotated[float, Within(0.0, 2.0)] = 0.4  # coefficient of the ground, uniform between the two
    friction_max: Annotated[float, Within(0.0, 2.0)] = 0.8
    command_timeout_s: Annotated[float, Within(0.004, 1.0)] = 0.050  # older commands damp
    latch_after_s: Annotated[float, Within(0.02, 10.0)] = 0.2  # damped so long, the gate awaits a person's command
    damping_kd: Annotated[float, Within(0.1, 20.0)] = 3.0  # joint damping of the safe state, DAMP [N m s/rad]
    kp_max: Annotated[float, Within(0.0, 2000.0)] = 500.0  # larger position gains are refused [N m/rad]
    kd_max: Annotated[float, Within(0.0, 100.0)] = 20.0  # larger velocity gains are refused [N m s/rad]
    solref_s: Annotated[float, Within(0.002, 0.1)] = (
        0.005  # time constant of contacts; soft defaults sink millimetres [s]
    )
    gate: Gate = field(default_factory=Gate)
    depth: DepthCamera = field(default_factory=DepthCamera)
    aliengo: Aliengo = field(default_factory=Aliengo)

    def __post_init__(self) -> None:
        ordered(self, "friction_min", "friction_max", "friction is drawn between the two")
