"""Settings of the emulated Aliengo: its wire, its motors, what is broken of it, and how its time goes."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import Annotated, Literal

from surefoot.config.aliengo import Button
from surefoot.config.robot import JOINT_NAMES
from surefoot.config.typed_toml import ConfigError, Within, ordered

Share = Annotated[float, Within(0.0, 1.0)]
Time = Annotated[float, Within(0.0, 1e5)]
Celsius = Annotated[float, Within(-40.0, 120.0)]


@dataclass(frozen=True)
class Wire:
    """What one direction of the link does to packets; every share is drawn for each packet on its own."""

    latency_s: Annotated[float, Within(0.0, 1.0)] = 0.0003  # of a wired link and the robot's board
    jitter_s: Annotated[float, Within(0.0, 1.0)] = 0.0002  # uniform, on top; packets may overtake one another
    loss: Share = 0.0
    duplicate: Share = 0.0  # comes twice, each with a jitter of its own
    reorder: Share = 0.0  # is held back, so that later ones overtake it
    reorder_s: Annotated[float, Within(0.0, 1.0)] = 0.005  # for so long
    corrupt: Share = 0.0  # is damaged
    corrupt_bits: Annotated[int, Within(1, 1000)] = 3  # of a damaged one, drawn
    bad_from_s: Time = 0.0  # of the robot's time: before and after, only latency and jitter are there
    bad_until_s: Time = 1e5

    def __post_init__(self) -> None:
        ordered(self, "bad_from_s", "bad_until_s", "the link would never be bad")


@dataclass(frozen=True)
class Motors:
    """What the robot's motors do beyond the law; what the vendor does not document can be either."""

    on_silence: Literal["hold", "brake"] = "hold"  # without commands: go on with the last one, or brake
    silence_s: Annotated[float, Within(0.002, 10.0)] = 0.020  # so long after the last one
    brake_kd: Annotated[float, Within(0.0, 200.0)] = (
        20.0  # of brake mode, as in the vendor's simulation [N m s/rad]
    )
    clamp_angles: bool = False  # of commands, into the robot's joint ranges, as the vendor's SDK can
    clamp_torque: Annotated[float, Within(0.0, 128.0)] = 128.0  # of tau in commands [N m]; 128: as it comes
    ambient: Celsius = 25.0  # at which motors and IMU begin [deg C]
    heating: Annotated[float, Within(0.0, 100.0)] = 0.05  # in the end, by a steady torque [K/(N m)^2]
    heating_s: Annotated[float, Within(0.01, 1e4)] = 120.0  # time constant
    overheated: Celsius = 90.0  # a hotter motor brakes [deg C]
    cooled: Celsius = 80.0  # until it is as cool as this

    def __post_init__(self) -> None:
        ordered(self, "cooled", "overheated", "a motor that brakes would never end or begin to")
        ordered(self, "ambient", "cooled", "a motor that has braked would never follow again")


Kind = Literal[
    "stuck encoder", "dead motor", "hot motor", "stuck imu", "stuck tick", "silent", "tipped over", "blow"
]  # fmt: skip


@dataclass(frozen=True)
class Fault:
    """Something that breaks, or is done to the robot, and perhaps comes right again."""

    kind: Kind
    joint: str = ""  # of an encoder or a motor
    begin_s: Time = 0.0  # of the robot's time
    end_s: Time = 1e5

    def __post_init__(self) -> None:
        if self.of_joint and self.joint not in JOINT_NAMES:
            raise ConfigError(f"joint = {self.joint!r}: a {self.kind} is one of {', '.join(JOINT_NAMES)}")
        if self.joint and not self.of_joint:
            raise ConfigError(f"joint = {self.joint!r}: {self.kind} is of the whole robot; leave it out")
        ordered(self, "begin_s", "end_s", "the fault would never be there")

    @property
    def of_joint(self) -> bool:
        """Whether it is of one joint, not of the whole robot."""
        return self.kind in ("stuck encoder", "dead motor", "hot motor")


@dataclass(frozen=True)
class Press:
    """Buttons of the remote that somebody holds for a while."""

    buttons: tuple[Button, ...]
    begin_s: Time  # of the robot's time
    end_s: Time

    def __post_init__(self) -> None:
        ordered(self, "begin_s", "end_s", "the buttons would never be held")


@dataclass(frozen=True)
class Emulator:
    """`surefoot emulator`. Port and generation are those of `hw.aliengo`, plant and seed those of `hw`."""

    listen: str = "127.0.0.1"  # address of this machine at which the robot answers; 0.0.0.0: at all
    pace: Literal["wall", "packets"] = "wall"  # packets: each that comes lets the robot's time go on by a cycle
    tick_unit: Literal["us", "ms"] = "us"  # of the robot's clock
    tick_start: Annotated[int, Within(0, 2**32 - 1)] = 0
    commands: Wire = field(default_factory=Wire)  # on their way to the robot
    states: Wire = field(default_factory=Wire)  # on their way back
    motors: Motors = field(default_factory=Motors)
    faults: tuple[Fault, ...] = ()
    presses: tuple[Press, ...] = ()
