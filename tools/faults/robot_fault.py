"""What may break of the robot or its link, and what has to come of it."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace
from enum import Enum
from math import ceil
from typing import Any

from surefoot.bus.messages import SimTruth
from surefoot.bus.topics import CYCLE_HZ
from surefoot.config.deployment import Deployment
from surefoot.config.emulator import Emulator, Fault, Kind, Wire
from surefoot.config.gate import Gate
from surefoot.hw.emulator.witness import tilt_of

Broken = Callable[[Emulator, float], Emulator]
"""The emulator's settings with something that breaks at a time [s]."""


class Declared(Enum):
    """What has to come of a fault, in the words of the page."""

    GOES_ON = "goes on"
    """The robot stays up and is driven."""
    DAMPED = "damped at once"
    """No motor is driven once a state has told of it and a command has come back."""
    DAMPED_LATE = "damped when the newest state is too old"
    """As above, after `hw.aliengo.stale_s` without a state."""
    DAMPED_STUCK = "damped when the IMU has been still too long"
    """As above, after `hw.gate.imu_stuck_cycles` states without a change of it."""
    DAMPED_MOTOR = "damped, upright, when a motor has not followed for too long"
    """From when much is asked of it: a cycle that is not known beforehand."""
    DAMPED_ENCODER = "upright; damped when its joint has to move"
    """Likewise."""
    DAMPED_TILT = "damped when it has tipped over"
    """As the first, after the trunk has tilted by `hw.gate.tilt_max`."""
    DAMPED_POWER = "damped when the motors turn over too much"
    """As the first, after six cycles above `hw.gate.power`."""
    UNHEARD = "io ends; the robot hears of nothing"
    """Nothing that is decided here reaches the robot."""


@dataclass(frozen=True)
class RobotFault:
    """One fault.

    Attributes:
        name: in words.
        broken: the settings with it.
        declared: what has to come of it.
        counts: from when on cycles count, where that is not from its begin: when the truth is such, by settings.
    """

    name: str
    broken: Broken
    declared: Declared
    counts: Callable[[SimTruth, Gate], bool] = lambda truth, gate: True


def part(kind: Kind, joint: str = "", seconds: float = 1e3) -> Broken:
    """A part of the robot, or a push, for so long."""
    return lambda emulator, t: replace(emulator, faults=(Fault(kind, joint, begin_s=t, end_s=t + seconds),))


def link(commands: dict[str, float], states: dict[str, float], seconds: float = 1e3) -> Broken:
    """Both ways of the link, each with its own settings for so long."""

    def worse(wire: Wire, settings: dict[str, float], t: float) -> Wire:
        burst: dict[str, Any] = {"loss": 0.0, "bad_from_s": t, "bad_until_s": t + seconds} | settings
        return replace(wire, **burst) if settings else wire

    return lambda emulator, t: replace(
        emulator, commands=worse(emulator.commands, commands, t), states=worse(emulator.states, states, t)
    )


def braking(broken: Broken) -> Broken:
    """The same, of a robot whose motors brake when no command comes; else they go on with the last."""

    def with_brakes(emulator: Emulator, t: float) -> Emulator:
        return replace(broken(emulator, t), motors=replace(emulator.motors, on_silence="brake"))

    return with_brakes


_POWER_CYCLES = 6
"""Above the limit, as the vendor counts."""

_DAMAGE, _TWICE = {"corrupt": 0.9, "corrupt_bits": 5}, {"duplicate": 1.0}
_SHUFFLE = {"reorder": 0.3, "reorder_s": 0.007}
_NOTHING: dict[str, float] = {}

FAULTS = (
    RobotFault("silent robot", part("silent"), Declared.DAMPED_LATE),
    RobotFault("stuck tick", part("stuck tick"), Declared.DAMPED_LATE),
    RobotFault("every state lost", link(_NOTHING, {"loss": 1.0}), Declared.DAMPED_LATE),
    RobotFault("every command lost", link({"loss": 1.0}, _NOTHING), Declared.UNHEARD),
    RobotFault("every command lost, and it brakes", braking(link({"loss": 1.0}, _NOTHING)), Declared.UNHEARD),
    RobotFault("both ways lost for 30 ms", link({"loss": 1.0}, {"loss": 1.0}, 0.030), Declared.GOES_ON),
    RobotFault("nine of ten damaged for 30 ms", link(_DAMAGE, _DAMAGE, 0.030), Declared.GOES_ON),
    RobotFault("every packet twice", link(_TWICE, _TWICE), Declared.GOES_ON),
    RobotFault("three of ten 7 ms late", link(_SHUFFLE, _SHUFFLE), Declared.GOES_ON),
    RobotFault("hot motor", part("hot motor", "RL_calf"), Declared.DAMPED),
    RobotFault("dead motor", part("dead motor", "RL_calf"), Declared.DAMPED_MOTOR),
    RobotFault("stuck encoder", part("stuck encoder", "RL_calf"), Declared.DAMPED_ENCODER),
    RobotFault("stuck IMU", part("stuck imu"), Declared.DAMPED_STUCK),
    RobotFault(
        "tipped over", part("tipped over", seconds=0.6), Declared.DAMPED_TILT,
        lambda truth, gate: tilt_of(truth.quat_WB) > gate.tilt_max,
    ),
    RobotFault(
        "blow from above", part("blow", seconds=0.04), Declared.DAMPED_POWER,
        lambda truth, gate: truth.power_w > gate.power,
    ),
)  # fmt: skip
"""In the order of the page."""


def damped_within_cycles(deployment: Deployment, declared: Declared) -> int | None:
    """From the first state that tells of a fault, or is missing, until no motor is driven, in cycles of 2 ms.

    The state has its way, where it is missing its predecessor grows too old, a cycle later io says so, and damping
    has its way.
    """
    own = {
        Declared.DAMPED: 0,
        Declared.DAMPED_LATE: ceil(deployment.hw.aliengo.stale_s * CYCLE_HZ),
        Declared.DAMPED_STUCK: deployment.hw.gate.imu_stuck_cycles,
        Declared.DAMPED_TILT: 0,
        Declared.DAMPED_POWER: _POWER_CYCLES,
    }
    if declared not in own:
        return None
    ways = (deployment.emulator.states, deployment.emulator.commands)
    seconds = sum(way.latency_s + way.jitter_s for way in ways)
    return ceil(seconds * CYCLE_HZ) + own[declared] + 2
