"""What has arrived of a process's inputs from other processes, in the writers' order."""

from __future__ import annotations

from collections import deque
from collections.abc import Callable, Iterable
from threading import Condition

from surefoot.bus.codec import decode
from surefoot.bus.errors import MessageError
from surefoot.bus.message import Message
from surefoot.bus.session import Session
from surefoot.bus.topics import TOPICS
from surefoot.components.component import Inbox

KEPT = 32
"""Messages of a topic that its writer keeps for a reader that comes late, or again."""

_WINDOW = 256  # bytes wait for a reader at the most; a number further ahead than this is not the writer's
_ON_ITS_WAY_S = 0.3
_MISFITS = 8  # so many messages out of sequence in a row are a new sequence


Ask = Callable[[str], list[bytes] | None]
"""The last messages of a topic, from who keeps them; None when nobody can be asked now."""


def _nobody(key: str) -> list[bytes]:
    """Nobody keeps any message of a topic."""
    return []


class _Topic:
    """One input: bytes not yet decoded, messages not yet visible, and where the writer's sequence stands."""

    def __init__(self, key: str):
        self.kind = TOPICS[key].message
        self.waiting: deque[bytes] = deque(maxlen=_WINDOW)
        self.early: dict[int, tuple[Message, int]] = {}
        self.had: dict[int, int] = {}
        self.arrivals = self.first = self.next = self.misfits = 0
        self.boot = -1

    def jump(self, seq: int) -> None:
        """Read on from a sequence number; what lies before it is of no interest."""
        self.first = self.next = seq
        for old in [each for each in self.early if each < seq]:
            del self.early[old]


class TopicBuffers:
    """Bytes in from the bus's thread, messages out to the step; a bad message is counted and dropped.

    With simulated time every message has its place, by its sequence number: what comes twice or out of place
    is another publisher's. On the monotonic clock the newest counts: of a stream that does not release the
    reader nothing else is even looked at, unless it asks for all, and what falls behind is dropped.

    Attributes:
        bad: messages dropped: malformed, or not of the topic's writer.
        last_error: what was wrong with the latest of them, by topic.
    """

    def __init__(self, keys: tuple[str, ...], trigger: str | None = None, complete: tuple[str, ...] = ()):
        """For the topics `keys`.

        Args:
            keys: the topics read.
            trigger: None with simulated time; on the monotonic clock the topic whose messages release the
                reader, or "".
            complete: streams of which every message is wanted.
        """
        self.bad = 0
        self.last_error = ""
        self._arrived = Condition()
        self._topics = {key: _Topic(key) for key in keys}
        self._trigger, self._complete = trigger, complete
        self._newest: dict[str, Callable[[], bytes | None]] = {}

    def connect(self, session: Session) -> None:
        """Begin to listen."""
        for key in self._topics:
            if self._trigger in (None, key) or key in self._complete or not TOPICS[key].rate_hz:
                session.subscribe(key, self.put)
            else:
                self._newest[key] = session.newest(key)

    def put(self, key: str, payload: bytes) -> None:
        """Store one message (the bus's thread)."""
        with self._arrived:
            topic = self._topics[key]
            topic.waiting.append(payload)
            topic.arrivals += 1
            if self._trigger in (None, key):
                self._arrived.notify_all()

    # Monotonic clock ------------------------------------------------------------------------------------

    def wait_arrivals(self, key: str, count: int, timeout_s: float) -> int:
        """Wait until `count` messages of a topic have arrived in all, or the time is up; how many have."""
        topic = self._topics[key]
        with self._arrived:
            self._arrived.wait_for(lambda: topic.arrivals >= count, timeout_s)
            return topic.arrivals

    def deliver_all(self, inbox: Inbox) -> None:
        """Hand over everything that has arrived."""
        for key, topic in self._topics.items():
            if key in self._newest and (payload := self._newest[key]()) is not None:
                topic.waiting.append(payload)
            while topic.waiting:
                message = self._decode(key, topic.waiting.popleft())
                if message is not None and self._in_sequence(key, topic, message):
                    inbox.deliver(key, message)

    @property
    def had(self) -> dict[str, tuple[int, int]]:
        """Of each topic the boot of the last message that was handed over, and the sequence number of the next."""
        return {key: (topic.boot, topic.next) for key, topic in self._topics.items()}

    def take_over(self, had: dict[str, tuple[int, int]]) -> None:
        """Read on from where another reader stood; what has arrived before that is nothing new."""
        for key, (boot, following) in had.items():
            topic = self._topics[key]
            topic.boot, topic.next, topic.first = boot, following, following

    def _in_sequence(self, key: str, topic: _Topic, message: Message) -> bool:
        """Whether a message follows the last one; a restarted writer, or a long row of misfits, begins anew."""
        if message.boot == topic.boot and message.seq < topic.first:
            return False
        ahead = message.seq - topic.next
        follows = message.boot > topic.boot or (message.boot == topic.boot and ahead >= 0)
        if follows or topic.misfits >= _MISFITS:
            topic.boot, topic.next, topic.misfits = message.boot, message.seq + 1, 0
            topic.first = 0
            return True
        topic.misfits += 1
        self._drop(f"{key}: message {message.seq} is out of place, next is {topic.next}: a second publisher?")
        return False

    # Simulated time -------------------------------------------------------------------------------------

    def resume(self, had: dict[str, int], visible: dict[str, int], kept: dict[str, list[bytes]], inbox: Inbox):
        """Take the place of a reader that is gone.

        Args:
            had: how many messages of each topic it had read.
            visible: how many are visible now.
            kept: what the writers still have of each topic.
            inbox: gets the last message that reader had of each topic, not as a new one.
        """
        for key, topic in self._topics.items():
            seen = had.get(key, 0)
            self._place(key, topic, kept.get(key, ()), seen - 1)
            oldest = min(topic.early, default=visible.get(key, 0))
            topic.jump(max(seen - 1, min(oldest, visible.get(key, 0)), 0))
            self._take(key, topic, seen, inbox)
        inbox.clear_new()

    def deliver_visible(self, visible: dict[str, int], inbox: Inbox, timeout_s: float, ask: Ask = _nobody) -> str:
        """Hand over exactly the messages with sequence numbers below the counts in `visible`.

        Waits for those that are still on their way, and asks for one that was sent before its reader was there,
        or while a link was down; one that nobody has kept is skipped.

        Returns:
            What did not come in time, in words; empty when all is there.
        """
        lost = ""
        for key, topic in self._topics.items():
            wanted = visible.get(key, 0)
            if wanted - topic.next > KEPT:
                topic.jump(wanted - KEPT)  # a reader that is released seldom needs the last ones only
            self._sort(key, topic)
            self._take(key, topic, wanted, inbox)
            while topic.next < wanted:
                missing = topic.next
                if not self._wait(topic, _ON_ITS_WAY_S):
                    kept = ask(key)
                    if kept is None:
                        continue  # nothing is lost yet
                    self._place(key, topic, kept, topic.next)
                    self._take(key, topic, wanted, inbox)
                if topic.next == missing and not self._wait(topic, timeout_s):
                    lost = f"{key}: message {topic.next} of {wanted} did not arrive in {timeout_s:g} s"
                    topic.jump(min([wanted, *topic.early]))
                self._sort(key, topic)
                self._take(key, topic, wanted, inbox)
        return lost

    def _take(self, key: str, topic: _Topic, wanted: int, inbox: Inbox) -> None:
        """Hand over, in order and without a gap, what is here up to the count."""
        while topic.next < wanted and topic.next in topic.early:
            message, topic.had[topic.next] = topic.early.pop(topic.next)
            topic.boot = max(topic.boot, message.boot)
            topic.had.pop(topic.next - KEPT, None)
            topic.next += 1
            inbox.deliver(key, message)

    def _wait(self, topic: _Topic, timeout_s: float) -> bool:
        with self._arrived:
            return self._arrived.wait_for(lambda: bool(topic.waiting), timeout_s)

    def _place(self, key: str, topic: _Topic, kept: Iterable[bytes], least: int) -> None:
        """Put what was kept for this reader in its place, from a sequence number on."""
        for payload in kept:
            message = self._decode(key, payload)
            if message is not None and message.seq >= least:
                there = topic.early.get(message.seq)
                if there is None or message.boot > there[0].boot:
                    topic.early[message.seq] = message, hash(payload)

    def _sort(self, key: str, topic: _Topic) -> None:
        """Decode what has arrived and put each message in its place, if that is free."""
        while topic.waiting:
            payload = topic.waiting.popleft()
            message = self._decode(key, payload)
            if message is None:
                continue
            seq, mark = message.seq, hash(payload)
            there = topic.early.get(seq)
            if seq < topic.first:
                continue
            if there is None and topic.next <= seq < topic.next + _WINDOW:
                topic.early[seq] = message, mark
            elif there is not None and message.boot > there[0].boot:
                topic.early[seq] = message, mark  # the writer was restarted before its step was over
            elif seq < topic.next and message.boot > topic.boot:
                continue  # said before by a process that went when its step was over
            elif mark not in (topic.had.get(seq), there and there[1]):
                self._drop(f"{key}: message {seq} is out of place, next is {topic.next}: a second publisher?")

    def _decode(self, key: str, payload: bytes) -> Message | None:
        try:
            return decode(self._topics[key].kind, payload)
        except MessageError as error:
            self._drop(f"{key}: {error}")
            return None

    def _drop(self, why: str) -> None:
        self.bad += 1
        self.last_error = why
