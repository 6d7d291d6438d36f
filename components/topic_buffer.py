"""What has arrived of one topic from another process, in the writer's order."""

from __future__ import annotations

from collections import deque
from threading import Condition

from surefoot.bus.codec import decode
from surefoot.bus.errors import MessageError
from surefoot.bus.message import Message
from surefoot.bus.topics import TOPICS
from surefoot.components.component import Inbox

_KEPT = 4096


class TopicBuffers:
    """Bytes in from the bus's thread, messages out to the step; a bad message is counted and dropped.

    Attributes:
        bad: messages dropped because they were malformed.
        last_error: what was wrong with the latest of them.
    """

    def __init__(self, keys: tuple[str, ...]):
        self.arrived = Condition()
        self.bad = 0
        self.last_error = ""
        self._waiting: dict[str, deque[bytes]] = {key: deque(maxlen=_KEPT) for key in keys}
        self._ready: dict[str, deque[Message]] = {key: deque(maxlen=_KEPT) for key in keys}
        self._next = dict.fromkeys(keys, 0)

    def put(self, key: str, payload: bytes) -> None:
        """Store one message (the bus's thread)."""
        with self.arrived:
            self._waiting[key].append(payload)
            self.arrived.notify_all()

    def start_after(self, counts: dict[str, int]) -> None:
        """Do not wait for the first messages of each topic: they were published before this reader was there."""
        for key in self._next:
            self._next[key] = counts.get(key, 0)

    def deliver_all(self, inbox: Inbox) -> int:
        """Hand over everything that has arrived; how many messages that were."""
        count = 0
        for key in self._waiting:
            self._decode(key)
            ready = self._ready[key]
            while ready:
                inbox.deliver(key, ready.popleft())
                count += 1
        return count

    def deliver_visible(self, visible: dict[str, int], inbox: Inbox, timeout_s: float) -> str:
        """Hand over exactly the messages with sequence numbers below the counts in `visible`.

        Waits for those that are still on their way; one that does not come is skipped.

        Returns:
            What did not come in time, in words; empty when all is there.
        """
        lost = ""
        for key in self._waiting:
            wanted = visible.get(key, 0)
            while self._next[key] < wanted:
                if not self._take(key, wanted, inbox) and not self._wait(key, timeout_s):
                    lost = f"{key}: message {self._next[key]} of {wanted} did not arrive in {timeout_s:g} s"
                    self._next[key] = wanted
        return lost

    def _take(self, key: str, wanted: int, inbox: Inbox) -> bool:
        """Hand over what is here up to the count; true when there was any."""
        self._decode(key)
        ready, before = self._ready[key], self._next[key]
        while ready and ready[0].seq < wanted:
            message = ready.popleft()
            inbox.deliver(key, message)
            self._next[key] = message.seq + 1
        return self._next[key] != before

    def _wait(self, key: str, timeout_s: float) -> bool:
        with self.arrived:
            return self.arrived.wait_for(lambda: bool(self._waiting[key]), timeout_s)

    def _decode(self, key: str) -> None:
        waiting, kind = self._waiting[key], TOPICS[key].message
        while waiting:
            try:
                self._ready[key].append(decode(kind, waiting.popleft()))
            except MessageError as error:
                self.bad += 1
                self.last_error = f"{key}: {error}"
