"""What is done to which process when, and what came of it."""

from __future__ import annotations

from dataclasses import dataclass

from surefoot.bus.messages import ControlMode, LegStatus, MotionReference
from surefoot.bus.topics import PROCESSES

FAULTS = ("kill", "pause", "restart")
"""SIGKILL; SIGSTOP for a second; `surefoot restart`."""

PHASES = ("standing", "base shift", "swing", "probing")


@dataclass(frozen=True)
class Case:
    """One fault: of `FAULTS`, to a process or to "all" of them, in a phase of `PHASES`."""

    phase: str
    fault: str
    process: str


@dataclass(frozen=True)
class Result:
    """What came of a case.

    Attributes:
        case: what was done.
        good: it went as is declared for this fault, process and clock.
        outcome: in words.
        told: what an operator could read of it.
        seconds: of the run's time until the robot was in its safe state; None where it needed none.
    """

    case: Case
    good: bool
    outcome: str
    told: str
    seconds: float | None = None


def phase_of(reference: MotionReference) -> str:
    """The phase that a reference is of; empty between two."""
    if reference.mode != ControlMode.BALANCE:
        return ""
    if (reference.leg_status == LegStatus.SWING).any():
        return "swing"
    if reference.state == "PROBE":
        return "probing"
    if reference.state in ("STAND", "STOPPED"):
        return "standing"
    return "base shift" if reference.state == "MOVE" and reference.t < reference.base_t1 else ""


def all_cases(phase: str) -> list[Case]:
    """Every fault to every process; the kill of io, which ends the run, comes last."""
    others = [name for name in PROCESSES if name != "io"]
    cases = [Case(phase, fault, name) for name in others for fault in FAULTS]
    return (
        cases
        + [Case(phase, fault, "io") for fault in ("restart", "pause")]
        + [Case(phase, "pause", "all")]
        + [Case(phase, "kill", "io")]
    )
