"""`surefoot status`: a stack that runs already, from outside."""

from __future__ import annotations

import json
import time
from collections.abc import Callable
from typing import Any

from rich.console import Console, RenderableType
from rich.live import Live

from surefoot.bus.errors import BusError
from surefoot.bus.hub_socket import hub_owner
from surefoot.bus.session import Session
from surefoot.bus.topics import TOPICS
from surefoot.config.deployment import Deployment, load_deployment
from surefoot.config.typed_toml import ConfigError
from surefoot.tools.diagnosis import troubles, why_nothing_moves
from surefoot.tools.observer import Observer
from surefoot.tools.picture import Picture, SupportMargin, Watched
from surefoot.tools.status_screen import screen
from surefoot.tools.supervisor_messages import NOTICE, Notice, unpack_notice
from surefoot.tools.teleop.tuned_run import tuned_already

_LISTEN_S = 1.5  # three statuses of every process
_DRAW_S = 0.25
_GONE_S = 1.5  # after so long without a word the hub is looked for, and as often
_RETRY_S = 0.5


class StackWatch:
    """One visit to a running stack.

    Attributes:
        session: on its bus.
        picture: what has been heard.
        ended: why the stack is no longer there; empty while it is.
    """

    def __init__(self, connect: Callable[[], Session]):
        """Begin to listen on the bus that `connect` opens.

        Raises:
            BusError: no stack runs there.
        """
        self._connect, self.session = connect, connect()
        self.where, self.namespace = self.session.where, self.session.namespace
        self.picture, self.ended = Picture(), ""
        self._observer = Observer(self.session, self.picture)
        self._notice: Notice | None = None
        self._deployment: Deployment | None = None
        self._take_notice = self.session.newest(NOTICE)
        self._begun = self._served = time.monotonic()
        self.picture.tuned = tuned_already(self.session)

    def look(self) -> None:
        """Take in what is new."""
        self._observer.look()
        payload = self._take_notice()
        if payload is not None:
            first, self._notice = self._notice is None, unpack_notice(payload)
            self.picture.note_notice(self._notice)
            if first:
                self._load(self._notice)
        heard = max(self._begun, *(watched.heard for watched in self.picture.processes.values()))
        if time.monotonic() - max(heard, self._served) > _GONE_S and not self._is_served():
            here = self.session.beside_hub
            silent = "io has ended and said no reason" if here else f"{self.where} does not answer any more"
            self.ended = self.picture.ending or silent

    def listen(self, seconds: float) -> None:
        """Look for so long, or until the stack ends."""
        end = time.monotonic() + seconds
        while time.monotonic() < end and not self.ended:
            self.look()
            time.sleep(0.05)

    def close(self) -> None:
        """End the visit."""
        self.session.close()

    @property
    def healthy(self) -> bool:
        """Whether the stack is there and nothing is the matter with any process."""
        return not (self.ended or self.picture.ending or troubles(self.picture))

    @property
    def title(self) -> str:
        """What is looked at."""
        if self._notice is None:
            return f"Surefoot, {self.namespace}: processes started by hand"
        clock = f", {self._deployment.run.clock} clock" if self._deployment is not None else ""
        name = self._notice.config.rpartition("/")[2]
        return f"Surefoot, {self.namespace}: {name}{clock}, supervisor {self._notice.pid}"

    def drawn(self) -> RenderableType:
        """The screen."""
        alternatives = self._deployment.fsm.alternatives if self._deployment is not None else None
        closing = f"The stack has ended: {self.ended}." if self.ended else ""
        return screen(self.picture, alternatives, self.title, closing)

    def table(self) -> dict[str, Any]:
        """All of it, for a script; times in seconds unless the name says otherwise."""
        picture, wrong = self.picture, troubles(self.picture)
        reference = picture.reference
        return {
            "namespace": self.namespace,
            "supervisor": self._notice.pid if self._notice is not None else None,
            "config": self._notice.config if self._notice is not None else None,
            "healthy": self.healthy,
            "why": why_nothing_moves(picture),
            "ended": self.ended,
            "t": picture.t,
            "state": reference.state if reference is not None else None,
            "real_time_factor": picture.real_time_factor(recent=True),
            "tuned": list(picture.tuned),
            "notes": picture.notes,
            "processes": {name: _row(watched, wrong.get(name, "")) for name, watched in picture.processes.items()},
        }

    def _is_served(self) -> bool:
        """Whether a hub listens; on this machine also one that is stopped."""
        if self.session.beside_hub:
            served = hub_owner(self.namespace) != ""
        else:
            served = _answers(self._connect)
        self._served = time.monotonic()
        return served

    def _load(self, notice: Notice) -> None:
        """The deployment, for the margin and the number of alternatives; the screen does without it too."""
        try:
            self._deployment = load_deployment(notice.config, notice.settings)
        except ConfigError:
            return  # the file has changed since, or lies on another machine
        self.picture.simulated = self._deployment.run.clock == "simulated"
        if not self.session.beside_hub:
            for name, watched in self.picture.processes.items():
                watched.host = self._deployment.network.host_of(name)
        self._observer.margin = SupportMargin(self._deployment.load_robot())


def show_once(connect: Callable[[], Session], wait: bool, as_json: bool, console: Console) -> int:
    """Print the status; 0 all is well, 1 something is not.

    Raises:
        BusError: no stack runs there, and none is waited for.
    """
    watch = _visit(connect, wait, console)
    watch.listen(_LISTEN_S)
    watch.close()
    if as_json:
        print(json.dumps(watch.table(), indent=2))
    else:
        console.print(f"connected to {watch.where}", watch.drawn(), sep="\n")
    return 0 if watch.healthy else 1


def show_live(connect: Callable[[], Session], wait: bool, console: Console) -> int:
    """Keep the status on the screen until Ctrl-C or the stack's end; with `wait` beyond that.

    Returns:
        0 all was well in the end, 1 something was not, or the stack has ended.

    Raises:
        BusError: no stack runs there, and none is waited for.
    """
    while True:
        watch = _visit(connect, wait, console)
        try:
            with Live(console=console, screen=True, auto_refresh=False) as live:
                while not watch.ended:
                    watch.listen(_DRAW_S)
                    live.update(watch.drawn(), refresh=True)
        except KeyboardInterrupt:
            return 0 if watch.healthy else 1
        finally:
            watch.close()
        console.print(watch.drawn())
        if not wait:
            return 1


def _visit(connect: Callable[[], Session], wait: bool, console: Console) -> StackWatch:
    """Connect, at once or as soon as there is something to connect to."""
    said = False
    while True:
        try:
            return StackWatch(connect)
        except BusError as error:
            if not wait:
                raise
            if not said:
                console.print(f"{error}; waiting for a stack, Ctrl-C ends that")
                said = True
        time.sleep(_RETRY_S)


def _answers(connect: Callable[[], Session]) -> bool:
    """Whether there is a way to a hub."""
    try:
        connect().close()
    except BusError:
        return False
    return True


def _row(watched: Watched, trouble: str) -> dict[str, Any]:
    """One process, for a script."""
    status = watched.status
    row: dict[str, Any] = {"trouble": trouble, "restarts": watched.restarts, "lent_to": watched.lent_to or None}
    if status is None:
        return row | {"life": None}
    inputs = [
        {
            "topic": key,
            "age_s": float(age) if age >= 0.0 else None,
            "stale_after_s": TOPICS[key].stale_after_s or None,
        }
        for key, age in zip(status.input, status.input_age_s, strict=False)
        if key in TOPICS
    ]
    names = ("life", "reason", "pid", "boot", "settings", "steps", "rate_hz", "nominal_hz")
    figures = ("step_p50_ms", "step_p99_ms", "step_max_ms", "overruns", "bad_messages")
    silent = round(time.monotonic() - watched.heard, 2)
    return row | {name: getattr(status, name) for name in names + figures} | {"silent_s": silent, "inputs": inputs}
