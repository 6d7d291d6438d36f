"""Settings of the real Aliengo: where it answers, what its packets mean, and what is plausible in them."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import Annotated, Literal

from surefoot.config.typed_toml import ConfigError, Within, ordered

LOOPBACK = ("127.0.0.1", "localhost")
"""This machine: what answers there is an emulator."""

# fmt: off
Button = Literal[
    "R1", "L1", "START", "SELECT", "R2", "L2", "F1", "F2", "A", "B", "X", "Y", "UP", "RIGHT", "DOWN", "LEFT",
]
"""Of the wireless remote."""
# fmt: on

Celsius = Annotated[float, Within(-128.0, 200.0)]


@dataclass(frozen=True)
class Reading:
    """What a state packet means where the vendor's files leave it open."""

    level_flag: Literal["low", "any"] = "low"  # any: a firmware that leaves it 0, as the vendor's SDK lets pass
    g0_quaternion: Literal["wxyz", "xyzw"] = "wxyz"  # generation G0 does not state its order; G1 is w, x, y, z
    accelerometer: Literal["up", "down"] = "up"  # what z reads at rest: up +9.8 (specific force), down -9.8


@dataclass(frozen=True)
class Plausible:
    """Beyond these figures a packet is garbage; generous, since the gate knows the limits that count."""

    angle_margin: Annotated[float, Within(0.0, 20.0)] = 1.0  # beyond the robot's joint ranges [rad]
    joint_speed: Annotated[float, Within(20.0, 1000.0)] = 60.0  # three times what a motor makes [rad/s]
    torque: Annotated[float, Within(45.0, 1000.0)] = 120.0  # the packet of generation G1 ends at 128 [N m]
    angular_velocity: Annotated[float, Within(5.0, 200.0)] = 40.0  # gyroscopes end at 2000 deg/s [rad/s]
    acceleration: Annotated[float, Within(20.0, 2000.0)] = 300.0  # per axis; sensors end at 16 g [m/s^2]
    temperature_min: Celsius = -50.0  # motors and IMU [deg C]
    temperature_max: Celsius = 125.0
    quaternion_norm_error: Annotated[float, Within(1e-4, 1.0)] = 0.05  # of the norm, from 1

    def __post_init__(self) -> None:
        ordered(self, "temperature_min", "temperature_max", "no temperature would be plausible")


@dataclass(frozen=True)
class Chords:
    """Buttons of the remote that stop the robot when all of them are held; an empty list has no meaning."""

    settle: tuple[Button, ...] = ("L2", "B")  # the vendor's own damps; whether on every Aliengo is not documented
    cut: tuple[Button, ...] = ("L1", "L2", "R1", "R2")  # both hands closed

    def __post_init__(self) -> None:
        if self.cut and set(self.cut) <= set(self.settle):
            raise ConfigError(
                f"cut = {list(self.cut)} is held with settle = {list(self.settle)}: nobody could only settle"
            )


@dataclass(frozen=True)
class Aliengo:
    """The real robot on its wire. The PC needs a fixed address in its network, such as 192.168.123.162/24."""

    generation: Literal["G0", "G1"] = "G1"  # G0: only the oldest, which answer with 684 bytes instead of 771
    address: str = "192.168.123.10"  # of the control board
    port: Annotated[int, Within(1, 65535)] = 8007  # of its low level
    local_port: Annotated[int, Within(0, 65535)] = 8082  # as in the vendor's examples, G0's have 8008; 0: any
    damping: Literal["gain", "brake"] = "gain"  # the safe state: hw.damping_kd alone, or the motors' brake mode
    law_timeout_s: Annotated[float, Within(0.004, 1.0)] = 0.020  # an older law is not sent any more: damping
    # Between two commands at the least [s]: what the vendor's examples allow as a period; their own is 0.002.
    gap_s: Annotated[float, Within(0.0005, 0.002)] = 0.001
    stale_s: Annotated[float, Within(0.004, 1.0)] = 0.050  # an older state is a fault
    first_answer_s: Annotated[float, Within(0.05, 60.0)] = 3.0  # how long the first good state is awaited
    tick_unit: Literal["auto", "us", "ms", "none"] = "auto"  # the vendor says both; none: time by arrival
    exchange: Literal["timer", "cycle"] = "timer"  # cycle: with each step of io, for an emulator that waits
    chords: Chords = field(default_factory=Chords)
    reading: Reading = field(default_factory=Reading)
    plausible: Plausible = field(default_factory=Plausible)

    def __post_init__(self) -> None:
        if not self.address.strip():
            raise ConfigError("address is empty: give the robot's, such as 192.168.123.10")
        if self.exchange == "cycle" and self.address not in LOOPBACK:
            raise ConfigError(
                f"exchange = 'cycle' with address = {self.address!r}: a robot would be without commands while io "
                f"waits; 'timer', or an emulator on this machine ({' or '.join(LOOPBACK)})"
            )
