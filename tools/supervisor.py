"""Starts every process of a deployment, watches them by name, restarts one on request, stops them in order."""

from __future__ import annotations

import os
import signal
import subprocess
import sys
import time
from collections.abc import Callable, Iterator
from contextlib import contextmanager, suppress
from pathlib import Path

from surefoot.bus.codec import decode
from surefoot.bus.endpoints import check_keys
from surefoot.bus.errors import BusError, MessageError
from surefoot.bus.messages import FsmEvent, MotionReference, OperatorCommand, ProcessStatus, StateEstimate
from surefoot.bus.service_keys import SUPERVISOR_REQUEST
from surefoot.bus.session import Session, refuse_second_hub
from surefoot.bus.topics import PROCESSES
from surefoot.components import clock_messages as clock
from surefoot.config.deployment import Deployment
from surefoot.tools.picture import Picture, SupportMargin, Watched

REQUEST = SUPERVISOR_REQUEST

MAX_CRASHES = 3
"""In simulation a process that ends by itself is started again as often as this."""

HOLDS_ROBOT = ("estimator", "wbc", "fsm")
"""On the monotonic clock these are restarted only while the robot rests: a few milliseconds pass without them.
The others may be at any time: the whole-body controller holds the base meanwhile."""

RESTS = ("DAMP", "STAND", "STOPPED")
"""States in which nothing moves."""

_KILL_AFTER_S = 3.0
_LOOK_S = 0.1
_HUB_S = 60.0
# The planner first, the hardware last: what is downstream keeps the robot while its upstream goes.
_STOP_ORDER = ("fsm", "trajopt", "elevation_map", "mpc", "wbc", "estimator", "io")


class Supervisor:
    """Reconciles wanted and running processes of one deployment.

    In simulation a process that ends by itself is started again, and simulated time waits for it. On the
    monotonic clock the run ends: the gate in io damps the robot as soon as commands are missing.

    It starts what `network.hosts` gives this machine; the rest it only hears. The machine of io begins the run.

    Attributes:
        picture: what has been heard, updated while `run` goes on.
    """

    def __init__(self, config: Path, overrides: list[str], deployment: Deployment):
        self._config, self._overrides, self._deployment = config, list(overrides), deployment
        self._simulated = deployment.run.clock == "simulated"
        if not self._simulated:
            self._overrides.append(f"run.epoch_s={time.monotonic()!r}")
        self._log_dir = Path(deployment.run.log_dir)
        self._margin = SupportMargin(deployment.load_robot())
        self.picture = Picture()
        self._network = deployment.network
        for name in PROCESSES:
            if name not in self._network.components_here:
                self.picture.processes[name].host = self._network.host_of(name)
        self._session: Session | None = None
        self._newest: dict[str, Callable[[], bytes | None]] = {}
        self._requests: list[str] = []
        self._successors: dict[str, subprocess.Popen] = {}

    def run(self, until: Callable[[Picture], str], each: Callable[[Picture], None] = lambda picture: None) -> str:
        """Start everything; until `until(picture)` gives a reason to end, which is returned.

        Whatever happens, no process is left behind.

        Raises:
            BusError: io did not come up or cannot be reached, another run has this namespace, or this machine's
                keys cannot be used.
        """
        at_hub = self._network.at_hub
        check_keys(self._network)
        if at_hub:
            refuse_second_hub(self._deployment.run.namespace)
        self._log_dir.mkdir(parents=True, exist_ok=True)
        try:
            if at_hub:
                self._start("io")
            self._session = self._connect()
            self._listen(self._session)
            self._await("io")
            if at_hub and self._simulated:
                self._command(self._deployment.run.command)
            for name in self._network.components_here:
                if name != "io":
                    self._start(name)
            if at_hub and not self._simulated:
                self._await("fsm")
                self._command(self._deployment.run.command)
            while True:
                self._hear()
                reason = until(self.picture) or self._reconcile()
                each(self.picture)
                if reason:
                    return reason
                time.sleep(_LOOK_S)
        finally:
            self.stop()

    def stop(self) -> None:
        """End every process in order, by force those that do not; a second Ctrl-C does not break it off."""
        with _deaf():
            for successor in self._successors.values():
                _end(successor)
            for name in _STOP_ORDER:
                _end(self.picture.processes[name].popen)
            if self._session is not None:
                self._session.close()
                self._session = None

    def restart(self, name: str) -> None:
        """Restart one process; what was done, or why not, is noted in the picture.

        On the monotonic clock its successor is started first and takes its place when it is ready.
        """
        if name not in PROCESSES:
            self.note(f"cannot restart {name!r}: there are {', '.join(PROCESSES)}")
        elif host := self.picture.processes[name].host:
            self.note(f"{name} is for the supervisor of {host} to restart")
        elif name == "io":
            self.note("cannot restart io: it holds the robot and the bus; stop the run instead")
        elif self._simulated:
            self._start_anew(name)
            self.note(f"{name} restarted on request")
        elif name in self._successors:
            self.note(f"{name} is being restarted already")
        elif name in HOLDS_ROBOT and self._state not in RESTS:
            self.note(
                f"cannot restart {name} in state {self._state or 'unknown'}: in real time nothing waits for it; "
                "`surefoot command stop` or sit first"
            )
        else:
            boot = self.picture.processes[name].restarts + 1
            self._successors[name] = self._launch(name, boot, "--relieve")

    @property
    def _state(self) -> str:
        """Of the state machine; empty before it has spoken."""
        reference = self.picture.reference
        return reference.state if reference is not None else ""

    def note(self, words: str) -> None:
        """Say something on the display and in the supervisor's log."""
        self.picture.notes.append(words)
        self._log_dir.mkdir(parents=True, exist_ok=True)
        with self._log_of("supervisor").open("a") as log:
            log.write(f"{self.picture.t:.3f} s  {words}\n")

    # Processes ------------------------------------------------------------------------------------------

    def _start(self, name: str) -> None:
        watched = self.picture.processes[name]
        watched.popen, watched.status = self._launch(name, watched.restarts), None

    def _launch(self, name: str, boot: int, *words: str) -> subprocess.Popen:
        settings = [word for override in self._overrides for word in ("--set", override)]
        command = [sys.executable, "-P", "-m", "surefoot.tools.cli", "child", str(self._config), name, *settings]
        command += ["--boot", str(boot), "--parent", str(os.getpid()), *words]
        with self._log_of(name).open("ab") as log:
            # A session of its own: Ctrl-C reaches the supervisor alone, which ends all in order.
            return subprocess.Popen(
                command, stdout=log, stderr=log, stdin=subprocess.DEVNULL, start_new_session=True
            )

    def _start_again(self, watched: Watched) -> None:
        watched.restarts += 1
        self._start(watched.name)

    def _start_anew(self, name: str) -> None:
        """End a process, then start it again."""
        watched = self.picture.processes[name]
        _end(watched.popen)
        self._start_again(watched)

    def _follow_successors(self) -> None:
        """See which have taken the place of their predecessors, and which have failed to."""
        for name, successor in list(self._successors.items()):
            watched = self.picture.processes[name]
            if watched.exit_code == 0:
                watched.popen, watched.restarts = successor, watched.restarts + 1
                self.note(f"{name} restarted on request")
            elif (code := successor.poll()) is None:
                continue
            elif name in HOLDS_ROBOT and self._state != "DAMP":
                self.note(f"{name} goes on as it was: its successor failed; {self._obituary(name, code)}")
            else:
                self._start_anew(name)
                self.note(f"{name} restarted on request, without its memory; {self._obituary(name, code)}")
            del self._successors[name]

    def _reconcile(self) -> str:
        """Obey requests; start again what ended; a reason to end the run, or ""."""
        while self._requests:
            verb, _, name = self._requests.pop(0).partition(" ")
            if verb == "restart":
                self.restart(name)
            elif verb == "stop":
                return "stopped by command"
        self._follow_successors()
        for watched in self.picture.processes.values():
            code = watched.exit_code
            if code is None:
                continue
            what = self._obituary(watched.name, code)
            if code == 0 and self._simulated and not self._network.at_hub:
                return f"the run on {self._network.hub} has ended"  # its clock has told the processes to end
            watched.crashes += 1
            if watched.name == "io" or not self._simulated:
                return what
            if watched.crashes > MAX_CRASHES:
                return f"{what}; it had been restarted {MAX_CRASHES} times"
            self._start_again(watched)
            self.note(f"{what}; restarted, {watched.crashes} of {MAX_CRASHES}")
        return ""

    def _obituary(self, name: str, code: int) -> str:
        """How a process ended, in words."""
        how = f"signal {-code}" if code < 0 else f"exit code {code}"
        log = self._log_of(name)
        lines = log.read_text(errors="replace").strip().splitlines() if log.exists() else []
        last = f" ({lines[-1][:160]})" if lines and code > 0 else ""
        return f"{name} ended with {how}{last}, see {log}"

    def _log_of(self, name: str) -> Path:
        return self._log_dir / f"{name}.log"

    # The bus --------------------------------------------------------------------------------------------

    def _connect(self) -> Session:
        """The bus, as soon as io holds it."""
        if not self._network.at_hub:
            return Session(self._deployment.run.namespace, connect_ms=round(1e3 * _HUB_S), network=self._network)
        io, end = self.picture.processes["io"], time.monotonic() + _HUB_S
        while True:
            try:
                return Session(self._deployment.run.namespace, connect_ms=1000, network=self._network)
            except BusError:
                code = io.exit_code
                if code is not None:
                    raise BusError(self._obituary(io.name, code)) from None
                if time.monotonic() > end:
                    raise BusError(
                        f"io did not open the bus in {_HUB_S:.0f} s, see {self._log_of('io')}"
                    ) from None

    def _await(self, name: str) -> None:
        """Until a process has spoken: what is published before its subscriptions stand is lost."""
        watched = self.picture.processes[name]
        while watched.status is None and watched.exit_code is None:
            time.sleep(_LOOK_S)

    def _listen(self, session: Session) -> None:
        self._newest = {key: session.newest(key) for key in ("state/estimate", "fsm/reference")}
        session.subscribe("status/*", self._on_status)
        session.subscribe("fsm/event", self._on_event)
        session.subscribe("operator/command", self._on_command)
        session.subscribe(REQUEST, lambda key, payload: self._requests.append(payload.decode(errors="replace")))

    def _command(self, command: str) -> None:
        """A command, given for the operator."""
        if not command:
            return
        if self._session is None:
            raise BusError(f"cannot give the command {command!r}: the bus is open only while `run` goes on")
        self._session.put(clock.REQUEST, command.encode())

    def _hear(self) -> None:
        # The readers that act on a malformed message count and report it; here the last good one stays.
        picture = self.picture
        for key, kind, name in (
            ("state/estimate", StateEstimate, "estimate"),
            ("fsm/reference", MotionReference, "reference"),
        ):
            payload = self._newest[key]()
            if payload is not None:
                with suppress(MessageError):
                    setattr(picture, name, decode(kind, payload))
        picture.note_time()
        if picture.estimate is not None and picture.reference is not None:
            picture.margin_m = self._margin(picture.estimate, picture.reference)

    def _on_status(self, key: str, payload: bytes) -> None:
        with suppress(MessageError):
            self.picture.note_status(decode(ProcessStatus, payload))

    def _on_event(self, key: str, payload: bytes) -> None:
        with suppress(MessageError):
            self.picture.note_event(decode(FsmEvent, payload))

    def _on_command(self, key: str, payload: bytes) -> None:
        with suppress(MessageError):
            self.picture.note_command(decode(OperatorCommand, payload).command)


def _end(popen: subprocess.Popen | None) -> None:
    """End a process, by force if it does not."""
    if popen is None or popen.poll() is not None:
        return
    popen.terminate()
    try:
        popen.wait(_KILL_AFTER_S)
    except subprocess.TimeoutExpired:
        popen.kill()
        popen.wait()


@contextmanager
def _deaf() -> Iterator[None]:
    """Signals that end a run are ignored."""
    before = {number: signal.signal(number, signal.SIG_IGN) for number in (signal.SIGINT, signal.SIGTERM)}
    try:
        yield
    finally:
        for number, handler in before.items():
            signal.signal(number, handler)
