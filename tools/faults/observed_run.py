"""A `surefoot run` in a process of its own, and all that it publishes and says."""

from __future__ import annotations

import os
import signal
import subprocess
import sys
import time
from collections.abc import Callable
from contextlib import suppress
from pathlib import Path
from threading import Lock
from typing import Any

from surefoot.bus.codec import decode
from surefoot.bus.errors import BusError
from surefoot.bus.messages import ProcessStatus
from surefoot.bus.service_keys import SUPERVISOR_REQUEST
from surefoot.bus.session import Session
from surefoot.bus.topics import PROCESSES, TOPICS
from surefoot.components import clock_messages as clock
from surefoot.config.deployment import load_deployment
from surefoot.tools.faults.case import phase_of

KEYS = tuple(key for key in TOPICS if not key.startswith("status/"))
_LOOK_S = 0.02
_END_S = 30.0


class RunOver(Exception):
    """The run has ended, or does not get on, while something was awaited of it."""


class ObservedRun:
    """Starts a run, listens to it, and reaches its processes.

    Attributes:
        deployment: what it runs.
        heard: all payloads of every topic, oldest first.
        status: the latest of each process.
    """

    def __init__(self, config: Path, settings: list[str], folder: Path, patience_s: float = 300.0):
        """`folder` is for its output and logs; what takes longer than `patience_s` of wall time is an error."""
        namespace = f"faults-{os.getpid()}-{folder.name}"
        settings = [*settings, f"run.namespace={namespace}", f"run.log_dir={folder / 'log'}"]
        self.deployment = load_deployment(config, settings)
        self.heard: dict[str, list[bytes]] = {key: [] for key in KEYS}
        self.status: dict[str, ProcessStatus] = {}
        self._told: list[str] = []
        self._patience_s, self._lock = patience_s, Lock()
        self._output = folder / "output"
        words = [word for setting in settings for word in ("--set", setting)]
        command = [sys.executable, "-P", "-m", "surefoot.tools.cli", "run", str(config), "--plain", *words]
        with self._output.open("wb") as output:
            self._popen = subprocess.Popen(command, stdout=output, stderr=output, stdin=subprocess.DEVNULL)
        self._session: Session | None = None
        self.wait(lambda: self._connect(namespace))

    # What it says ---------------------------------------------------------------------------------------

    @property
    def t(self) -> float:
        """Time of the run [s]; -1 before it has begun."""
        return self.last("hw/state").t if self.heard["hw/state"] else -1.0

    @property
    def phase(self) -> str:
        """Of `case.PHASES`, or empty."""
        return phase_of(self.last("fsm/reference")) if self.heard["fsm/reference"] else ""

    @property
    def over(self) -> bool:
        """Whether the run has ended."""
        return self._popen.poll() is not None

    def last(self, key: str) -> Any:
        """The newest message of a topic."""
        return decode(TOPICS[key].message, self.heard[key][-1])

    def since(self, key: str, t: float) -> list[Any]:
        """Messages of a topic later than t [s]."""
        found: list[Any] = []
        for payload in reversed(self.heard[key]):
            message = decode(TOPICS[key].message, payload)
            if message.t <= t:
                break
            found.append(message)
        return found[::-1]

    def words(self, about: str, mark: tuple[int, int] = (0, 0)) -> str:
        """The last that was printed, or else told in a status, about something; of what came after `mark`."""
        for lines in (self._lines()[mark[0] :], self._told[mark[1] :]):
            about_it = [line.strip() for line in lines if about in line]
            if about_it:
                return about_it[-1]
        return ""

    def mark(self) -> tuple[int, int]:
        """A place in what has been printed and told so far."""
        return len(self._lines()), len(self._told)

    # What is done to it ---------------------------------------------------------------------------------

    def command(self, word: str) -> None:
        """Tell the robot what to do."""
        self._put(clock.REQUEST, word)

    def restart(self, process: str) -> None:
        """Ask the supervisor for a restart."""
        self._put(SUPERVISOR_REQUEST, f"restart {process}")

    def signal(self, process: str, number: int) -> None:
        """Send a signal to a process, or to "all" of them.

        Raises:
            RunOver: it has ended by itself.
        """
        for name in PROCESSES if process == "all" else (process,):
            try:
                os.kill(self.status[name].pid, number)
            except ProcessLookupError:
                self.wait_end()
                raise RunOver(self.ending()) from None

    def go_on(self, process: str) -> None:
        """Let a process, or "all", go on after a stop; one that went with its run meanwhile stays away."""
        for name in PROCESSES if process == "all" else (process,):
            with suppress(ProcessLookupError):
                os.kill(self.status[name].pid, signal.SIGCONT)

    def wait(self, holds: Callable[[], bool], what: str = "") -> None:
        """Until `holds()`.

        Raises:
            RunOver: the run has ended, or patience.
        """
        end = time.monotonic() + self._patience_s
        while not holds():
            if self._popen.poll() is not None:
                raise RunOver(self.ending())
            if time.monotonic() > end:
                awaited = f"{what or 'what was awaited'} did not come in {self._patience_s:.0f} s"
                raise RunOver(f"{awaited} ({self._why_not()})")
            time.sleep(_LOOK_S)

    def _why_not(self) -> str:
        """What the state machine and the processes say."""
        references = self.heard["fsm/reference"]
        said = [f"{self.last('fsm/reference').state} at {self.t:.1f} s"] if references else ["no state yet"]
        said += [f"{name}: {status.reason}" for name, status in sorted(self.status.items()) if status.reason]
        silent = [name for name in PROCESSES if name not in self.status]
        return "; ".join(said + ([f"silent: {', '.join(silent)}"] if silent else []))

    def wait_end(self) -> float:
        """Until the run is over, by force if need be; how long that took [s]."""
        begun = time.monotonic()
        try:
            self._popen.wait(_END_S)
        except subprocess.TimeoutExpired:
            self._popen.kill()
            self._popen.wait()
        return time.monotonic() - begun

    def ending(self) -> str:
        """The reason of the run's end, as it was printed."""
        lines = self._lines()
        after = [lines[index - 1] for index, line in enumerate(lines) if "of the run's time" in line]
        return after[-1] if after else (lines[-1] if lines else "")

    def left_behind(self) -> list[str]:
        """Processes that are still there."""
        return [name for name, status in self.status.items() if _lives(status.pid)]

    def close(self) -> None:
        """End it in order."""
        for status in self.status.values():
            if _lives(status.pid):
                os.kill(status.pid, signal.SIGCONT)
        if not self.over:
            self._popen.terminate()
        self.wait_end()
        if self._session is not None:
            self._session.close()

    def _lines(self) -> list[str]:
        return self._output.read_text(errors="replace").splitlines()

    # The bus --------------------------------------------------------------------------------------------

    def _connect(self, namespace: str) -> bool:
        try:
            session = Session(namespace, connect_ms=500)
        except BusError:
            return False
        for key in KEYS:
            session.subscribe(key, lambda key, payload: self.heard[key].append(payload))
        session.subscribe("status/*", self._on_status)
        self._session = session
        return True

    def _put(self, key: str, word: str) -> None:
        if self._session is not None:
            self._session.put(key, word.encode())

    def _on_status(self, key: str, payload: bytes) -> None:
        status = decode(ProcessStatus, payload)
        self.status[status.process] = status
        if status.reason:
            self._told.append(f"{status.process}: {status.reason}")


def _lives(pid: int) -> bool:
    try:
        state = Path(f"/proc/{pid}/stat").read_text().rsplit(")", 1)[1].split()[0]
    except OSError:
        return False
    return state != "Z"
