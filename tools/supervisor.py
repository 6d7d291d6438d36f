"""Starts every process of a deployment, watches them by name, restarts one on request, stops them in order."""

from __future__ import annotations

import os
import subprocess
import sys
import time
from collections.abc import Callable
from contextlib import suppress
from dataclasses import dataclass, field
from pathlib import Path

from surefoot.bus.codec import decode, encode
from surefoot.bus.errors import MessageError
from surefoot.bus.messages import FsmEvent, MotionReference, OperatorCommand, ProcessStatus, StateEstimate
from surefoot.bus.session import Session
from surefoot.bus.topics import PROCESSES
from surefoot.components import clock_messages as clock
from surefoot.config.deployment import Deployment

REQUEST = "supervisor/request"
"""Key on which `surefoot restart NAME` reaches the supervisor: "restart NAME"."""

_KILL_AFTER_S = 3.0
_LOOK_S = 0.1
# The planner first, the hardware last: what is downstream keeps the robot while its upstream goes.
_STOP_ORDER = ("fsm", "trajopt", "elevation_map", "mpc", "wbc", "estimator", "io")


@dataclass
class Watched:
    """One process of the run."""

    name: str
    popen: subprocess.Popen | None = None
    restarts: int = 0
    status: ProcessStatus | None = None
    heard: float = 0.0


@dataclass
class Picture:
    """What the supervisor has heard of the run, for a status display."""

    processes: dict[str, Watched] = field(default_factory=dict)
    reference: MotionReference | None = None
    estimate: StateEstimate | None = None
    events: list[FsmEvent] = field(default_factory=list)
    began: float = 0.0
    ended: str = ""


class Supervisor:
    """Reconciles wanted and running processes of one deployment.

    A process of the control chain that ends by itself in simulation is started again; simulated time waits.

    Attributes:
        picture: what has been heard, updated while `run` goes on.
    """

    def __init__(self, config: Path, overrides: list[str], deployment: Deployment):
        self._config, self._overrides, self._deployment = config, list(overrides), deployment
        if deployment.run.clock == "monotonic":
            self._overrides.append(f"run.epoch_s={time.monotonic()!r}")
        self._log_dir = Path(deployment.run.log_dir)
        self.picture = Picture({name: Watched(name) for name in PROCESSES}, began=time.monotonic())
        self._session: Session | None = None
        self._requests: list[str] = []

    def run(self, until: Callable[[Picture], str], each: Callable[[Picture], None] = lambda picture: None) -> str:
        """Start everything; until `until(picture)` gives a reason to end, which is returned.

        Whatever happens, no process is left behind.
        """
        self._log_dir.mkdir(parents=True, exist_ok=True)
        try:
            self._start("io")
            self._session = Session(self._deployment.run.namespace)
            self._listen()
            self._await_hub()
            if self._deployment.run.clock == "simulated":
                self._command(self._deployment.run.command)
            for name in PROCESSES:
                if name != "io":
                    self._start(name)
            if self._deployment.run.clock == "monotonic":
                self._command(self._deployment.run.command)
            while True:
                reason = until(self.picture) or self._reconcile()
                each(self.picture)
                if reason:
                    self.picture.ended = reason
                    return reason
                time.sleep(_LOOK_S)
        finally:
            self.stop()

    def stop(self) -> None:
        """End every process in order, by force those that do not."""
        for name in _STOP_ORDER:
            self._end(self.picture.processes[name])
        if self._session is not None:
            self._session.close()
            self._session = None

    def restart(self, name: str) -> str:
        """Restart one process; returns what was done, or why not."""
        if name not in PROCESSES:
            return f"no process {name!r}; there are {', '.join(PROCESSES)}"
        if name == "io":
            return "io holds the robot and the bus: stop the run instead"
        watched = self.picture.processes[name]
        self._end(watched)
        watched.restarts += 1
        self._start(name)
        return f"{name} restarted"

    def _start(self, name: str) -> None:
        settings = [word for override in self._overrides for word in ("--set", override)]
        log = (self._log_dir / f"{name}.log").open("ab")
        command = [sys.executable, "-P", "-m", "surefoot.tools.cli", "child", str(self._config), name, *settings]
        self.picture.processes[name].popen = subprocess.Popen(
            command, stdout=log, stderr=log, stdin=subprocess.DEVNULL, env=dict(os.environ)
        )
        log.close()

    @staticmethod
    def _end(watched: Watched) -> None:
        popen = watched.popen
        if popen is None or popen.poll() is not None:
            return
        popen.terminate()
        try:
            popen.wait(_KILL_AFTER_S)
        except subprocess.TimeoutExpired:
            popen.kill()
            popen.wait()

    def _reconcile(self) -> str:
        """Obey requests; start again what ended; a reason to end the run, or ""."""
        while self._requests:
            verb, _, name = self._requests.pop(0).partition(" ")
            if verb == "restart":
                self.restart(name)
            elif verb == "stop":
                return "stopped by command"
        for watched in self.picture.processes.values():
            code = None if watched.popen is None else watched.popen.poll()
            if code is None:
                continue
            where = f"exit code {code}, see {self._log_dir / (watched.name + '.log')}"
            if watched.name == "io" or self._deployment.run.clock == "monotonic" or watched.restarts >= 3:
                return f"{watched.name} ended: {where}"
            watched.restarts += 1
            self._start(watched.name)
        return ""

    def _await_hub(self) -> None:
        """Until io has spoken: what is published before its subscriptions stand is lost."""
        io = self.picture.processes["io"]
        while io.status is None and io.popen.poll() is None:
            time.sleep(_LOOK_S)

    def _listen(self) -> None:
        session = self._session
        session.subscribe("status/*", self._on_status)
        session.subscribe("fsm/reference", lambda key, payload: self._on(MotionReference, "reference", payload))
        session.subscribe("state/estimate", lambda key, payload: self._on(StateEstimate, "estimate", payload))
        session.subscribe("fsm/event", self._on_event)
        session.subscribe(REQUEST, lambda key, payload: self._requests.append(payload.decode(errors="replace")))

    def _command(self, command: str) -> None:
        """The deployment's own command, given for the operator."""
        if not command:
            return
        if self._deployment.run.clock == "simulated":
            self._session.put(clock.REQUEST, command.encode())
        else:
            t = time.monotonic() - self.picture.began
            time.sleep(2.0)  # the state machine must have joined the bus to hear it
            self._session.put("operator/command", encode(OperatorCommand(t=t, valid=True, command=command)))

    def _on(self, kind: type, name: str, payload: bytes) -> None:
        # The readers that act on a malformed message count and report it.
        with suppress(MessageError):
            setattr(self.picture, name, decode(kind, payload))

    def _on_status(self, key: str, payload: bytes) -> None:
        try:
            status = decode(ProcessStatus, payload)
        except MessageError:
            return
        watched = self.picture.processes.get(status.process)
        if watched is not None:
            watched.status, watched.heard = status, time.monotonic()

    def _on_event(self, key: str, payload: bytes) -> None:
        with suppress(MessageError):
            self.picture.events.append(decode(FsmEvent, payload))
