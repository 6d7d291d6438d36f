"""Starts every process of a deployment, watches them by name, restarts one on request, stops them in order."""

from __future__ import annotations

import os
import queue
import signal
import subprocess
import sys
import time
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from pathlib import Path

from surefoot.bus.endpoints import check_keys
from surefoot.bus.errors import BusError
from surefoot.bus.service_keys import SUPERVISOR_REQUEST
from surefoot.bus.session import Session, refuse_second_hub
from surefoot.bus.topics import PROCESSES
from surefoot.components import clock_messages as clock
from surefoot.config.deployment import Deployment
from surefoot.tools.guardian import Guardian
from surefoot.tools.observer import Observer
from surefoot.tools.other_process import OtherProcess
from surefoot.tools.picture import Picture, SupportMargin, Watched
from surefoot.tools.recording.recorder_process import NAME as RECORDER
from surefoot.tools.recording.recorder_process import RecorderProcess
from surefoot.tools.reload.source_watch import SourceWatch
from surefoot.tools.restart_queue import RestartQueue
from surefoot.tools.supervisor_messages import (
    ANSWER,
    NOTICE,
    Answer,
    Notice,
    Post,
    pack_answer,
    pack_notice,
)

MAX_CRASHES = 3
"""In simulation a process that ends by itself is started again as often as this."""

HOLDS_ROBOT = ("estimator", "wbc", "fsm")
"""On the monotonic clock these are restarted only while the robot rests: a few milliseconds pass without them.
The others may be at any time: the whole-body controller holds the base meanwhile."""

ENDS_RUN = (signal.SIGINT, signal.SIGTERM, signal.SIGHUP)
"""Ctrl-C, `kill`, and a terminal that is closed end a run in order."""

KILL_AFTER_S = 3.0
"""A process that has not ended so long after it was told to is killed: a stop takes at most this for each."""

RESTS = ("DAMP", "STAND", "STOPPED")
"""States in which nothing moves."""

_LOOK_S = 0.1
_NOTICE_S = 0.5
_NOTES = 5  # the last ones, in a notice
_UP_AGAIN_S = 30.0  # a restarted process is given so long before the next one goes, or it once more
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

    def __init__(
        self,
        config: Path,
        overrides: list[str],
        deployment: Deployment,
        sources: SourceWatch | None = None,
        record: Path | None = None,
    ):
        """For a deployment.

        Args:
            config: its file.
            overrides: assignments on top of it.
            deployment: what both give.
            sources: restart what is made of them when they change (simulated time only).
            record: the file that a recorder writes, beside the processes.
        """
        self._config, self._overrides, self._deployment = config, list(overrides), deployment
        self._simulated = deployment.run.clock == "simulated"
        if not self._simulated:
            self._overrides.append(f"run.epoch_s={time.monotonic()!r}")
        self._log_dir = Path(deployment.run.log_dir)
        self._sources = sources
        self._record = record
        self._recorder: RecorderProcess | None = None
        self.picture = Picture(simulated=self._simulated)
        self._network = deployment.network
        for name in PROCESSES:
            if name not in self._network.components_here:
                self.picture.processes[name].host = self._network.host_of(name)
        self._session: Session | None = None
        self._observer: Observer | None = None
        self._guardian: Guardian | None = None
        self._requests: queue.SimpleQueue[str] = queue.SimpleQueue()
        self._queue = RestartQueue(self.picture, _UP_AGAIN_S)
        self._borrowers: dict[str, OtherProcess] = {}
        self._notice_due = 0.0
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
            self._guardian = Guardian(self._log_of("supervisor"))
            if at_hub:
                self._start("io")
            self._session = self._connect()
            self._listen(self._session)
            self._await_io(each)
            self._start_recorder(each)
            first = self._deployment.run.command if at_hub else ""
            if self._simulated:
                self._command(first)
            for name in self._network.components_here:
                if name != "io":
                    self._start(name)
            while True:
                self._look(each)
                # In real time nobody keeps a command for one that does not listen yet.
                if not self._simulated and first and self.picture.processes["fsm"].status is not None:
                    self._command(first)
                    first = ""
                reason = until(self.picture) or self._reconcile()
                if reason:
                    self.picture.ending = reason
                    return reason
                time.sleep(_LOOK_S)
        finally:
            self.stop()

    def stop(self) -> None:
        """End every process in order, by force those that do not; a second Ctrl-C does not break it off."""
        with _deaf():
            self.picture.ending = self.picture.ending or "its supervisor was told to stop"
            self._tell()
            for successor in self._successors.values():
                _end(successor)
            for name in _STOP_ORDER:
                self._end(self.picture.processes[name])
            if self._recorder is not None:
                self._recorder.end()
                self._note_recorder()
            if self._session is not None:
                self._session.close()
                self._session = None
            if self._guardian is not None:
                self._guardian.close()
                self._guardian = None

    def restart(self, name: str, why: str = "on request") -> None:
        """Restart one process; what was done, or why not, is noted in the picture.

        On the monotonic clock its successor is started first and takes its place when it is ready.
        """
        if name not in PROCESSES:
            self.note(f"cannot restart {name!r}: there are {', '.join(PROCESSES)}")
        elif refusal := self._refusal(name):
            self.note(f"cannot restart {name}{refusal}")
        elif self._simulated:
            self._start_anew(name)
            self.note(f"{name} restarted {why}")
        else:
            boot = self.picture.processes[name].restarts + 1
            self._successors[name] = self._launch(name, boot, "--relieve")

    def lend(self, name: str, pid: int) -> None:
        """Leave a process to one that somebody runs by hand, until that one ends."""
        try:
            borrower = OtherProcess(pid)
        except ProcessLookupError:
            self.note(f"cannot lend {name} to process {pid}: there is none")
            return
        refusal = self._refusal(name) if name in PROCESSES else f": there are {', '.join(PROCESSES)}"
        if refusal:
            self.note(f"cannot lend {name} to process {pid}{refusal}")
            self._answer(pid, Answer(-1, f"the run does not lend {name}{refusal}"))
            borrower.close()
            return
        watched = self.picture.processes[name]
        self._end(watched)
        watched.popen, watched.lent_to = None, pid
        self._borrowers[name] = borrower
        self._start_again(watched)
        self.note(f"{name} lent to process {pid}; it is started again here when that one ends")

    def _refusal(self, name: str) -> str:
        """Why a process cannot be replaced now, to follow its name; empty if it can."""
        if host := self.picture.processes[name].host:
            return f": it is for the supervisor of {host}"
        if name == "io":
            return ": it holds the robot and the bus; stop the run instead"
        if lent_to := self.picture.processes[name].lent_to:
            return f": it is lent to process {lent_to}; end that one"
        if name in self._successors:
            return ": it is being restarted already"
        if name in HOLDS_ROBOT and not self._simulated and self._state not in RESTS:
            return (
                f" in state {self._state or 'unknown'}: in real time nothing waits for it; "
                "`surefoot command stop` or sit first"
            )
        return ""

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
        watched.status, watched.out = None, ""
        if watched.lent_to:
            self._answer(watched.lent_to, Answer(watched.restarts))  # who borrowed it starts it
            return
        watched.popen = self._launch(name, watched.restarts)

    def _launch(self, name: str, boot: int, *words: str) -> subprocess.Popen:
        settings = [word for override in self._overrides for word in ("--set", override)]
        command = [sys.executable, "-P", "-m", "surefoot.tools.cli", "child", str(self._config), name, *settings]
        command += ["--boot", str(boot), "--parent", str(os.getpid()), *words]
        with self._log_of(name).open("ab") as log:
            # A session of its own: Ctrl-C reaches the supervisor alone, which ends all in order.
            popen = subprocess.Popen(
                command, stdout=log, stderr=log, stdin=subprocess.DEVNULL, start_new_session=True
            )
        if self._guardian is not None:
            self._guardian.watch(popen.pid, name)
        return popen

    def _start_recorder(self, each: Callable[[Picture], None]) -> None:
        """Before the other processes: their first messages are to be there too."""
        if self._record is None:
            return
        namespace = self._deployment.run.namespace
        self._recorder = RecorderProcess(self._record, namespace, self._log_of(RECORDER))
        if self._guardian is not None:
            self._guardian.watch(self._recorder.pid, RECORDER)
        while not self._recorder.ready:
            self._look(each)
            time.sleep(_LOOK_S)

    def _note_recorder(self) -> None:
        """Say how the recorder has ended."""
        if self._recorder is not None and (words := self._recorder.obituary()):
            self._recorder = None
            self.note(words)

    def _start_again(self, watched: Watched) -> None:
        watched.restarts += 1
        self._start(watched.name)

    def _end(self, watched: Watched) -> None:
        """End a process: one of ours by force if need be; one that somebody runs by hand is told to."""
        borrower = self._borrowers.pop(watched.name, None)
        if borrower is not None:
            watched.lent_to = 0
            borrower.signal(signal.SIGTERM)
            borrower.wait(KILL_AFTER_S)
            borrower.close()
        _end(watched.popen)

    def _start_anew(self, name: str) -> None:
        """End a process, then start it again."""
        watched = self.picture.processes[name]
        self._end(watched)
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
        while not self._requests.empty():
            verb, *words = self._requests.get().split() or [""]
            if verb == "stop":
                return "stopped by command"
            if verb == "restart" and len(words) == 1:
                self._ask_restart(words[0], "on request")
            elif verb == "lend" and len(words) == 2 and words[1].isdecimal():
                self.lend(words[0], int(words[1]))
            else:
                self.note(f"not understood: {' '.join([verb, *words])[:80]!r}")
        self._follow_successors()
        if reason := self._bury() or self._take_back():
            return reason
        self._note_recorder()
        self._reload()
        if (due := self._queue.next()) is not None:
            self.restart(*due)
        return ""

    def _ask_restart(self, name: str, why: str) -> None:
        """Restart a process as soon as those asked for before it are up again."""
        if name in PROCESSES and not self._refusal(name):
            if words := self._queue.add(name, why):
                self.note(words)
        else:
            self.restart(name, why)  # says why not

    def _bury(self) -> str:
        """Start again what has ended by itself; a reason to end the run, or ""."""
        for watched in self.picture.processes.values():
            code = watched.exit_code
            if code is None:
                continue
            what = self._obituary(watched.name, code)
            if code == 0 and self._simulated and not self._network.at_hub:
                return f"the run on {self._network.hub} has ended"  # its clock has told the processes to end
            if self._sources is not None and watched.name != "io" and code > 0:
                # The same source would end in the same way.
                watched.popen = None
                watched.out = f"{what.removeprefix(watched.name).strip()}; it waits for its source to change"
                self.note(f"{watched.name} {watched.out}")
                continue
            watched.crashes += 1
            if watched.name == "io" or not self._simulated:
                return what
            if watched.crashes > MAX_CRASHES:
                return f"{what}; it had been restarted {MAX_CRASHES} times"
            self._start_again(watched)
            self.note(f"{what}; restarted, {watched.crashes} of {MAX_CRASHES}")
        return ""

    def _take_back(self) -> str:
        """Run again what was lent to a process that has ended; a reason to end the run, or ""."""
        for name, borrower in list(self._borrowers.items()):
            if not borrower.gone:
                continue
            self._borrowers.pop(name).close()
            watched = self.picture.processes[name]
            watched.lent_to = 0
            if refusal := self._refusal(name):
                return f"process {borrower.pid}, which had {name}, has ended{refusal}"
            self._start_again(watched)
            self.note(f"process {borrower.pid} has ended: {name} is started again here")
        return ""

    def _reload(self) -> None:
        """Restart what is made of sources that have changed."""
        change = self._sources.changed() if self._sources is not None else None
        if change is None:
            return
        for words in change.notes:
            self.note(words)
        for name in change.processes:
            self._ask_restart(name, f"after a change of {change.what}")

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

    def _await_io(self, each: Callable[[Picture], None]) -> None:
        """Until it has spoken: what is published before its subscriptions stand is lost."""
        io = self.picture.processes["io"]
        while io.status is None and io.exit_code is None:
            self._look(each)
            time.sleep(_LOOK_S)

    def _listen(self, session: Session) -> None:
        self._observer = Observer(session, self.picture, SupportMargin(self._deployment.load_robot()))
        session.subscribe(
            SUPERVISOR_REQUEST, lambda key, payload: self._requests.put(payload.decode(errors="replace"))
        )
        session.serve(NOTICE, lambda: [self._notice()])

    def _look(self, each: Callable[[Picture], None]) -> None:
        """Hear what is new, tell what this supervisor knows, show both."""
        if self._observer is not None:
            self._observer.look()
        if time.monotonic() >= self._notice_due:
            self._tell()
        each(self.picture)

    def _tell(self) -> None:
        """Publish the notice."""
        self._notice_due = time.monotonic() + _NOTICE_S
        if self._session is not None:
            self._session.put(NOTICE, self._notice(), lossless=False)

    def _notice(self) -> bytes:
        picture = self.picture
        now = time.monotonic()
        posts = {
            name: Post(each.restarts, each.lent_to, each.out, each.silent_s(now))
            for name, each in picture.processes.items()
        }
        return pack_notice(
            Notice(
                pid=os.getpid(),
                config=str(self._config.resolve()),
                settings=self._overrides,
                processes=posts,
                notes=picture.notes[-_NOTES:],
                ending=picture.ending,
            )
        )

    def _answer(self, pid: int, answer: Answer) -> None:
        if self._session is not None:
            self._session.put(f"{ANSWER}/{pid}", pack_answer(answer))

    def _command(self, command: str) -> None:
        """A command, given for the operator."""
        if not command:
            return
        if self._session is None:
            raise BusError(f"cannot give the command {command!r}: the bus is open only while `run` goes on")
        self._session.put(clock.REQUEST, command.encode())


def _end(popen: subprocess.Popen | None) -> None:
    """End a process, by force if it does not."""
    if popen is None or popen.poll() is not None:
        return
    popen.terminate()
    popen.send_signal(signal.SIGCONT)  # one that is stopped can still end in order
    try:
        popen.wait(KILL_AFTER_S)
    except subprocess.TimeoutExpired:
        popen.kill()
        popen.wait()


@contextmanager
def _deaf() -> Iterator[None]:
    """Signals that end a run are ignored."""
    before = {number: signal.signal(number, signal.SIG_IGN) for number in ENDS_RUN}
    try:
        yield
    finally:
        for number, handler in before.items():
            signal.signal(number, handler)
