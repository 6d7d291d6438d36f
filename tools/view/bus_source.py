"""A running stack: the view only subscribes, and of a stream it keeps the newest message."""

from __future__ import annotations

import time
from collections import deque
from collections.abc import Callable
from concurrent.futures import ThreadPoolExecutor
from contextlib import suppress

from surefoot.bus.codec import decode
from surefoot.bus.errors import BusError, MessageError
from surefoot.bus.message import Message
from surefoot.bus.session import Session
from surefoot.bus.topics import TOPICS
from surefoot.components.deployment_desk import ask_deployment
from surefoot.config.deployment import Deployment
from surefoot.config.typed_toml import build, without_unknown
from surefoot.tools.picture import Picture
from surefoot.tools.stack_watch import StackWatch
from surefoot.tools.teleop.remote import Remote
from surefoot.tools.view.heard import STREAMS, Heard
from surefoot.tools.view.history import RARE

_RETRY_S = 2.0
_OF_PICTURE = ("hardware", "estimate", "reference")
"""Streams that the picture of a run has heard already."""

_RARE = tuple(key for key in RARE if key not in ("fsm/event", "operator/command"))
"""Those that it has not."""


class BusSource:
    """One visit after another to the stack of a namespace: when one run ends, the next is waited for.

    Attributes:
        deployment: as io tells it; None before it has.
        heard: of the present run, or of the last.
        remote: commands the robot; None while there is none. It is no heartbeat: a page that is open does not say
            that a person is there.
    """

    def __init__(self, connect: Callable[[], Session], wait: bool):
        """Begin to listen on the bus that `connect` opens.

        Args:
            connect: raises a BusError while there is none.
            wait: for a stack, if none runs yet.

        Raises:
            BusError: no stack runs there, and none is waited for.
        """
        # A run in simulated time waits for the threads that take messages off the bus. They inherit the priority
        # of who makes them: here of one thread that keeps its own, even if the caller has given way meanwhile.
        self._visitor = ThreadPoolExecutor(max_workers=1)
        self._connect = connect
        self._visit: _Visit | None = None
        self.deployment: Deployment | None = None
        self.heard = Heard()
        self.remote: Remote | None = None
        self._asked = self._tried = 0.0
        self._ended = ""
        try:
            self._visit = self._visitor.submit(_Visit, connect).result()
        except BusError as error:
            if not wait:
                raise
            self._ended = str(error)
            self._tried = time.monotonic()

    @property
    def title(self) -> str:
        """What is looked at."""
        return self._visit.watch.title if self._visit is not None else "Surefoot"

    @property
    def picture(self) -> Picture | None:
        """Of the run."""
        return self._visit.watch.picture if self._visit is not None else None

    @property
    def words(self) -> str:
        """That there is no run, or not yet all of it."""
        if self._ended:
            return f"{self._ended}; the next run is shown as soon as it is there"
        return "" if self.deployment is not None else "the stack comes up: io has not said yet what is running"

    def look(self) -> None:
        """Take in what is new; where the run has ended, look for the next."""
        now = time.monotonic()
        if self._visit is None or self._ended:
            if now - self._tried > _RETRY_S:
                self._visit_again()
                self._tried = time.monotonic()
            return
        self._visit.take_into(self.heard)
        if self.deployment is None and now - self._asked > _RETRY_S:
            self._learn(self._visit.watch.session)
            self._asked = time.monotonic()
        if self._visit.watch.ended:
            self._ended = f"the run has ended: {self._visit.watch.ended}"
            self.remote = None
            self._visit.watch.close()

    def close(self) -> None:
        """Leave the bus."""
        if self._visit is not None and not self._ended:
            self._visit.watch.close()
        self._visitor.shutdown()

    def _learn(self, session: Session) -> None:
        """What is running; a stack that is just starting does not say it yet."""
        with suppress(BusError):
            tables, _ = without_unknown(Deployment, ask_deployment(session))
            self.remote = Remote(session, beats=False)
            self.deployment = build(Deployment, tables)

    def _visit_again(self) -> None:
        with suppress(BusError):
            self._visit = self._visitor.submit(_Visit, self._connect).result()
            self._ended, self.deployment, self.heard = "", None, Heard()


class _Visit:
    """What is subscribed to on one bus."""

    def __init__(self, connect: Callable[[], Session]):
        self.watch = StackWatch(connect)
        self._rare: deque[tuple[str, bytes]] = deque(maxlen=1000)
        self._events, self._command = 0, ""
        session = self.watch.session
        self._take = {name: session.newest(key) for name, key in STREAMS.items() if name not in _OF_PICTURE}
        for key in _RARE:
            session.subscribe(key, lambda key, payload: self._rare.append((key, payload)))

    def take_into(self, heard: Heard) -> None:
        """Everything that has arrived since the last time."""
        self.watch.look()
        picture = self.watch.picture
        for name in _OF_PICTURE:
            heard.note(name, getattr(picture, name))
        for name, take in self._take.items():
            payload = take()
            if payload is not None and (message := _decoded(STREAMS[name], payload)) is not None:
                heard.note(name, message)
        rare: list[Message] = [*picture.events[self._events :]]
        self._events = len(picture.events)
        while self._rare:
            if (message := _decoded(*self._rare.popleft())) is not None:
                rare.append(message)
        for message in sorted(rare, key=lambda each: each.t):
            heard.history.note(message)
        heard.history.command = picture.command


def _decoded(key: str, payload: bytes) -> Message | None:
    """The message; None if it is malformed: who acts on it counts and tells that, a display keeps the last."""
    try:
        return decode(TOPICS[key].message, payload)
    except MessageError:
        return None
