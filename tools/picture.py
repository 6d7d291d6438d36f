"""What a run looks like from outside: all that a display, a summary or a verdict needs."""

from __future__ import annotations

import subprocess
import time
from collections import Counter, deque
from dataclasses import dataclass, field

import numpy as np
import pinocchio as pin

from surefoot.bus.messages import FsmEvent, HardwareState, MotionReference, ProcessStatus, StateEstimate
from surefoot.bus.topics import PROCESSES
from surefoot.components.fsm.support_triangle import SupportTriangle
from surefoot.components.fsm.words import is_direction
from surefoot.components.robot_model import build_model
from surefoot.config.robot import Robot
from surefoot.tools.supervisor_messages import Notice

RATE_BAND = 0.2
"""A rate is well within so much of nominal."""

_RECENT_S = 10.0


@dataclass
class Watched:
    """One process of the run.

    Attributes:
        host: the machine that runs it; "" this one.
    """

    name: str
    host: str = ""
    popen: subprocess.Popen | None = None
    restarts: int = 0
    crashes: int = 0
    status: ProcessStatus | None = None
    heard: float = 0.0  # monotonic clock of the last status [s]
    slow: int = 0  # statuses in a row whose rate was below nominal
    lent_to: int = 0  # id of the process that stands in for it; 0 none does
    out: str = ""  # in words why none runs
    told_silent_s: float = -1.0  # since a supervisor elsewhere heard of it; -1 it never has

    def silent_s(self, now: float) -> float:
        """How long it has not been heard, here or by the supervisor; -1 it never was.

        Args:
            now: monotonic clock [s].
        """
        return now - self.heard if self.status is not None else self.told_silent_s

    def begin_anew(self) -> None:
        """Another takes its place; nothing has been heard of that one."""
        self.restarts += 1
        self.status, self.out = None, ""

    @property
    def exit_code(self) -> int | None:
        """How it ended; None while it runs, or before it was started."""
        return self.popen.poll() if self.popen is not None else None


@dataclass
class Picture:
    """What the supervisor has heard of the run.

    Attributes:
        processes: by name.
        reference, estimate, hardware: the newest messages, or None.
        margin_m: distance of the centre of mass from the edge of the triangle of the feet other than the leg
            that is moved or probed, positive inside; None while four feet stand.
        events: of the state machine, oldest first.
        counts: how many events of each kind.
        displacement_m: the largest of a foot on the ground.
        command: what was commanded last; empty before.
        direction: of the walk that was commanded last; empty before.
        tuned: settings that a person has changed in this run, `section.key=value`.
        notes: what the supervisor did, in words.
        ending: in words why the run ends; empty while it goes on.
        simulated: time is known to wait for every process.
    """

    processes: dict[str, Watched] = field(default_factory=lambda: {name: Watched(name) for name in PROCESSES})
    reference: MotionReference | None = None
    estimate: StateEstimate | None = None
    hardware: HardwareState | None = None
    margin_m: float | None = None
    events: list[FsmEvent] = field(default_factory=list)
    counts: Counter[str] = field(default_factory=Counter)
    displacement_m: float = 0.0
    command: str = ""
    direction: str = ""
    tuned: tuple[str, ...] = ()
    notes: list[str] = field(default_factory=list)
    ending: str = ""
    simulated: bool = False
    _advanced: tuple[float, float] | None = None  # the run's time that io told last, and when here [s]
    _clock: deque[tuple[float, float]] = field(default_factory=deque)
    _first: tuple[float, float] | None = None

    @property
    def t(self) -> float:
        """Time of the run [s]."""
        return self.reference.t if self.reference is not None else 0.0

    @property
    def state(self) -> str:
        """Of the state machine; empty before it has spoken."""
        return self.reference.state if self.reference is not None else ""

    @property
    def restarts(self) -> int:
        """Of all processes."""
        return sum(watched.restarts for watched in self.processes.values())

    @property
    def all_there(self) -> bool:
        """Whether every process has spoken."""
        return all(watched.status is not None for watched in self.processes.values())

    def note_event(self, event: FsmEvent) -> None:
        """Take in an event."""
        self.events.append(event)
        self.counts[event.kind] += 1
        self.displacement_m = max(self.displacement_m, event.displacement_m)

    def note_command(self, command: str) -> None:
        """Take in what the robot was told."""
        self.command = command
        if is_direction(command):
            self.direction = command

    def note_status(self, status: ProcessStatus) -> None:
        """Take in what a process says of itself."""
        watched = self.processes.get(status.process)
        if watched is None or status.boot < watched.restarts:
            return  # the last words of one that has been replaced
        low = status.rate_hz < (1.0 - RATE_BAND) * status.nominal_hz
        watched.slow = watched.slow + 1 if low else 0
        watched.status, watched.heard = status, time.monotonic()

    def note_notice(self, notice: Notice) -> None:
        """Take in what the run's supervisor says of it."""
        for name, post in notice.processes.items():
            watched = self.processes.get(name)
            if watched is not None:
                if watched.status is not None and watched.status.boot < post.restarts:
                    watched.status = None
                watched.restarts, watched.lent_to = post.restarts, post.lent_to
                watched.out, watched.told_silent_s = post.out, post.silent_s
        self.notes, self.ending = list(notice.notes), notice.ending

    def note_time(self) -> None:
        """Mark how far the run's clock has come by now."""
        if self.hardware is not None and (self._advanced is None or self._advanced[0] != self.hardware.t):
            self._advanced = self.hardware.t, time.monotonic()
        if self.reference is None:
            return
        now = time.monotonic(), self.t
        if self._first is None and self.t > 0.0:
            self._first = now
        self._clock.append(now)
        while now[0] - self._clock[0][0] > _RECENT_S:
            self._clock.popleft()

    def stood_s(self, now: float) -> float:
        """How long io has not advanced the run's time, as far as it was heard; 0 before that has begun.

        Args:
            now: monotonic clock [s].
        """
        return now - self._advanced[1] if self._advanced is not None else 0.0

    def real_time_factor(self, recent: bool = False) -> float:
        """Seconds of the run for each second on the wall: over the last ten seconds, or since time began."""
        if self._first is None:
            return 0.0
        (wall0, t0), (wall1, t1) = self._clock[0] if recent else self._first, self._clock[-1]
        return (t1 - t0) / max(wall1 - wall0, 1e-3)


class SupportMargin:
    """How far the centre of mass lies inside the feet that carry."""

    def __init__(self, robot: Robot):
        self._model = build_model(robot)
        self._data = self._model.createData()

    def __call__(self, estimate: StateEstimate, reference: MotionReference) -> float | None:
        """[m], positive inside; None while no leg is moved or probed."""
        if reference.leg < 0:
            return None
        com_W = self.com(estimate.p_WB, estimate.quat_WB, estimate.q)
        return SupportTriangle(reference.p_WF, reference.leg).margin(com_W[:2])

    def com(self, p_WB: np.ndarray, quat_WB: np.ndarray, q: np.ndarray) -> np.ndarray:
        """(3,) centre of mass in the world [m]; of the trunk's place, quaternion (w, x, y, z) and joint angles."""
        w, x, y, z = quat_WB
        return pin.centerOfMass(self._model, self._data, np.concatenate([p_WB, [x, y, z, w], q])).copy()
