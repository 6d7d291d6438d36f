"""How a process on the monotonic clock hands its place to another that is ready for it, between two steps.

The successor has warmed up and listens before it asks. It is shown where the other stands, to see that it can take
over from there; then it asks for the place itself. What answers that is the last that its predecessor does.
"""

from __future__ import annotations

import queue
import time
from dataclasses import astuple, dataclass

import msgpack

from surefoot.bus.errors import BusError
from surefoot.bus.service_keys import RELIEF_ANSWER as _ANSWER
from surefoot.bus.service_keys import RELIEF_ASK as _ASK
from surefoot.bus.session import Marked, Session

SHOW, GIVE = b"show", b"give"
"""What a successor asks: where the process stands, or its place."""

_PATIENCE_S = 5.0


@dataclass(frozen=True)
class Place:
    """Where a process stands between two steps.

    Attributes:
        t: time of the last step [s].
        boot: of its messages.
        sent: how many messages it has published on each topic.
        had: of each topic it reads the boot of the last message and the sequence number of the next.
        latest: of each topic it reads the last message, in bytes; of one that has had none there is none.
        snapshot: the component's memory, packed; empty while it is not active.
    """

    t: float
    boot: int
    sent: dict[str, int]
    had: dict[str, tuple[int, int]]
    latest: dict[str, bytes]
    snapshot: bytes


class Relief:
    """Both sides of it, for the process of a name."""

    def __init__(self, session: Session, name: str):
        self._session, self._name = session, name
        self._heard: queue.SimpleQueue[bytes] = queue.SimpleQueue()

    def expect(self) -> None:
        """Begin to listen for a successor."""
        self._session.subscribe(f"{_ASK}/{self._name}", lambda key, payload: self._heard.put(payload))

    def asked(self) -> bytes:
        """What a successor asks, once; empty when nobody does. Other words are not heeded."""
        try:
            while (word := self._heard.get_nowait()) not in (SHOW, GIVE):
                pass
        except queue.Empty:
            return b""
        return word

    def answer(self, place: Place) -> None:
        """Tell the successor."""
        self._session.put(f"{_ANSWER}/{self._name}", msgpack.packb(astuple(place)))

    def listen(self) -> None:
        """Begin to listen for a predecessor's answers."""
        self._session.subscribe(f"{_ANSWER}/{self._name}", lambda key, payload: self._heard.put(payload))

    def ask(self, word: bytes) -> Place:
        """The predecessor's answer to `SHOW` or `GIVE`; what is none is not heeded.

        Who is given the place publishes under its predecessor's mark: no reader can tell the two apart.

        Raises:
            BusError: there is none.
        """
        self._session.put(f"{_ASK}/{self._name}", word)
        end = time.monotonic() + _PATIENCE_S
        while True:
            try:
                payload = self._heard.get(timeout=max(end - time.monotonic(), 0.0))
            except queue.Empty:
                raise BusError(
                    f"{self._name} has not answered its successor for {_PATIENCE_S:g} s: it hangs, or is not there"
                ) from None
            try:
                place = Place(*msgpack.unpackb(payload))
            except Exception:  # of a second publisher
                continue
            if word == GIVE and isinstance(payload, Marked):
                self._session.mark = payload.writer
            return place
