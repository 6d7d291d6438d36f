"""What may break of the robot or its link, and what has to come of it."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace
from math import ceil
from typing import Any

from surefoot.bus.topics import CYCLE_HZ
from surefoot.config.deployment import Deployment
from surefoot.config.emulator import Emulator, Fault, Kind, Wire

Broken = Callable[[Emulator, float], Emulator]
"""The emulator's settings with something that breaks at a time [s]."""


@dataclass(frozen=True)
class RobotFault:
    """One fault.

    Attributes:
        name: in words.
        broken: the settings with it.
        damps: the motors must be damped in time; else the robot must stay up and be driven on. None: nobody looks
            for it, so that nothing is declared.
        heard: commands still reach the robot; if they do not, nothing that is decided here does.
    """

    name: str
    broken: Broken
    damps: bool | None
    heard: bool = True


def part(kind: Kind, joint: str = "") -> Broken:
    """A part of the robot."""
    return lambda emulator, t: replace(emulator, faults=(Fault(kind, joint, begin_s=t),))


def link(commands: dict[str, float], states: dict[str, float], seconds: float = 1e3) -> Broken:
    """Both ways of the link, each with its own settings for so long."""

    def worse(wire: Wire, settings: dict[str, float], t: float) -> Wire:
        burst: dict[str, Any] = {"loss": 0.0, "bad_from_s": t, "bad_until_s": t + seconds} | settings
        return replace(wire, **burst) if settings else wire

    return lambda emulator, t: replace(
        emulator, commands=worse(emulator.commands, commands, t), states=worse(emulator.states, states, t)
    )


_DAMAGE, _TWICE = {"corrupt": 0.9, "corrupt_bits": 5}, {"duplicate": 1.0}
_SHUFFLE = {"reorder": 0.3, "reorder_s": 0.007}
_NOTHING: dict[str, float] = {}

FAULTS = (
    RobotFault("silent robot", part("silent"), damps=True),
    RobotFault("stuck tick", part("stuck tick"), damps=True),
    RobotFault("every state lost", link(_NOTHING, {"loss": 1.0}), damps=True),
    RobotFault("every command lost", link({"loss": 1.0}, _NOTHING), damps=False, heard=False),
    RobotFault("both ways lost for 30 ms", link({"loss": 1.0}, {"loss": 1.0}, 0.030), damps=False),
    RobotFault("nine of ten damaged for 30 ms", link(_DAMAGE, _DAMAGE, 0.030), damps=False),
    RobotFault("every packet twice", link(_TWICE, _TWICE), damps=False),
    RobotFault("three of ten 7 ms late", link(_SHUFFLE, _SHUFFLE), damps=False),
    RobotFault("hot motor", part("hot motor", "RL_calf"), damps=None),
    RobotFault("dead motor", part("dead motor", "RL_calf"), damps=None),
    RobotFault("stuck encoder", part("stuck encoder", "RL_calf"), damps=None),
    RobotFault("stuck IMU", part("stuck imu"), damps=None),
)
"""In the order of the page."""


def damped_within_cycles(deployment: Deployment) -> int:
    """From the first state that is missing until no motor is driven, in cycles of 2 ms.

    The newest state has had its way, grows too old, and a cycle later io says so; then damping has its way.
    """
    ways = (deployment.emulator.states, deployment.emulator.commands)
    seconds = deployment.hw.aliengo.stale_s + sum(way.latency_s + way.jitter_s for way in ways)
    return ceil(seconds * CYCLE_HZ) + 2
