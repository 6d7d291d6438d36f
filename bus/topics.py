"""The topic table and the process table: the one place where a key, a rate or a budget is written."""

from __future__ import annotations

from dataclasses import dataclass

from surefoot.bus import messages as m
from surefoot.bus.message import Message
from surefoot.config.depth_camera import DepthCamera


@dataclass(frozen=True)
class Topic:
    """One key of the bus.

    Attributes:
        key: what follows the namespace on the wire.
        message: its type.
        writer: the one process that publishes it.
        rate_hz: nominal rate; 0 when published on an event.
        stale_after_s: a consumer must not act on older content; 0 when age means nothing.
        recorded: part of a log.
    """

    key: str
    message: type[Message]
    writer: str
    rate_hz: float = 0.0
    stale_after_s: float = 0.0
    recorded: bool = True


@dataclass(frozen=True)
class Process:
    """When a process steps, and how long after its release its output becomes visible.

    Attributes:
        name: of the component.
        rate_hz: of its timer; 0 for a process triggered by messages.
        trigger: the topic whose messages release it; empty for a timer.
        every: releases on every n-th message of the trigger.
        budget_s: logical execution time.
        urgency: on the monotonic clock the more urgent interrupts the less; 0: as any program, it may be late.
        core: which of a machine's cores it keeps to when it is urgent; the last where there are fewer.
    """

    name: str
    rate_hz: float = 0.0
    trigger: str = ""
    every: int = 1
    budget_s: float = 0.0
    urgency: int = 0
    core: int = 0


CYCLE_HZ = 500.0
"""Of the robot's interface: how often its sensors are read and its motors get a command."""

TOLD_S = 10.0
"""What went wrong once, with a message or on the link to the robot, is told in a process's status for so long."""

_WBC_EVERY = 2
"""The whole-body controller steps on every n-th cycle."""

_FSM_HZ = 250.0

_MAP_HZ = 50.0
"""Faster than the camera: a foothold request is not kept waiting."""

MPC_RATE_HZ = {"paper": 100.0, "light": 50.0}
"""Of each profile of the MPC; a solve may take its whole period."""


def processes(mpc_profile: str = "paper") -> dict[str, Process]:
    """The process table, in the order in which processes released at the same instant step."""
    mpc_hz = MPC_RATE_HZ[mpc_profile]
    table = (
        Process("io", rate_hz=CYCLE_HZ, urgency=5),
        Process("estimator", trigger="hw/state", budget_s=0.001, urgency=4),
        Process("wbc", trigger="state/estimate", every=_WBC_EVERY, budget_s=0.001, urgency=3, core=1),
        Process("mpc", rate_hz=mpc_hz, budget_s=1.0 / mpc_hz, urgency=1, core=2),
        Process("fsm", rate_hz=_FSM_HZ, budget_s=0.002, urgency=2, core=1),
        Process("trajopt", trigger="trajopt/request", budget_s=0.100),
        Process("elevation_map", rate_hz=_MAP_HZ, budget_s=0.020),
    )
    return {process.name: process for process in table}


PROCESSES = processes()
"""The process table of the paper's profile; the names are the same in every profile."""

TOPICS = {
    topic.key: topic
    for topic in (
        Topic("hw/state", m.HardwareState, "io", CYCLE_HZ, 0.040),
        Topic("hw/depth", m.DepthFrame, "io", DepthCamera.rate_hz, 0.5),
        Topic("joint/command", m.JointCommand, "wbc", CYCLE_HZ / _WBC_EVERY, 0.040),
        Topic("state/estimate", m.StateEstimate, "estimator", CYCLE_HZ, 0.040),
        Topic("fsm/reference", m.MotionReference, "fsm", _FSM_HZ, 0.100),
        Topic("fsm/event", m.FsmEvent, "fsm"),
        Topic("mpc/policy", m.Policy, "mpc", MPC_RATE_HZ["paper"], 0.100),
        Topic("trajopt/request", m.PlanRequest, "fsm"),
        Topic("trajopt/plan", m.Plan, "trajopt"),
        Topic("foothold/request", m.FootholdRequest, "fsm"),
        Topic("foothold/regions", m.FootholdRegions, "elevation_map"),
        Topic("map/elevation", m.ElevationGrid, "elevation_map"),
        Topic("operator/command", m.OperatorCommand, "operator"),
        Topic("operator/answer", m.OperatorAnswer, "fsm"),
        Topic("operator/tuning", m.Tuning, "operator"),
        Topic("sim/truth", m.SimTruth, "io", CYCLE_HZ),
        *(Topic(f"status/{name}", m.ProcessStatus, name, 2.0, 2.0) for name in PROCESSES),
    )
}


def nominal_hz(process: Process) -> float:
    """Steps a second that a process is to make; 0 when it steps on events."""
    return process.rate_hz or TOPICS[process.trigger].rate_hz / process.every


def topic(key: str) -> Topic:
    """The topic of a key.

    Raises:
        KeyError: the key is not in the table; the message lists those that are.
    """
    try:
        return TOPICS[key]
    except KeyError:
        raise KeyError(f"no topic {key!r}; the table has {', '.join(TOPICS)}") from None
