"""What has arrived of a process's inputs from other processes, in the writers' order."""

from __future__ import annotations

import time
from collections import deque
from collections.abc import Callable, Iterable, Mapping, Sequence
from threading import Condition

from surefoot.bus.codec import decode
from surefoot.bus.errors import MessageError
from surefoot.bus.message import Message
from surefoot.bus.session import Marked, Session
from surefoot.bus.topics import PROCESSES, TOPICS
from surefoot.components.component import Inbox
from surefoot.components.incidents import Incidents
from surefoot.components.input_sequence import KEPT, WINDOW, InputSequence

_ON_ITS_WAY_S = 0.3
_MISFITS = 8  # so many messages out of sequence in a row are a new sequence
_SILENT_S = 1.0  # a writer that has been silent for so long may be another than before


Ask = Callable[[str], Sequence[bytes] | None]
"""The last messages of a topic, from who keeps them; None when nobody can be asked now."""


def _nobody(key: str) -> list[bytes]:
    """Nobody keeps any message of a topic."""
    return []


class TopicBuffers:
    """Bytes in from the bus's thread, messages out to the step; a bad message is counted and dropped.

    With simulated time the clock's master says which sessions may publish, and every message has its place, by
    its sequence number: what comes from elsewhere, twice or out of place is another publisher's. On the monotonic
    clock the newest counts: of a stream that does not release the reader nothing else is even looked at, unless
    it asks for all, and what falls behind is dropped. There the writer is the session that was heard first, after
    a restart, which `boot` tells, the next; another is heard only if that one has been silent.

    Attributes:
        bad: messages dropped: malformed, or not of the topic's writer.
        incidents: what was wrong with the latest of them on each key.
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
        self.incidents = Incidents()
        self._arrived = Condition()
        self._topics = {key: InputSequence(key) for key in keys}
        self._trigger, self._complete = trigger, complete
        self._newest: dict[str, Callable[[], bytes | None]] = {}
        self._trusted: dict[str, frozenset[bytes]] | None = None

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
            topic.store(payload)
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
                topic.store(payload)
            for payload in self._take_waiting(topic):
                message = self._decode(key, payload)
                if message is not None and self._in_sequence(key, topic, message, payload):
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

    def _in_sequence(self, key: str, topic: InputSequence, message: Message, payload: bytes) -> bool:
        """Whether a message follows the last one; a restarted writer, or a long row of misfits, begins anew."""
        known = topic.is_of_writer(message, payload)
        if known and message.boot == topic.boot and message.seq < topic.first:
            return False
        ahead = message.seq - topic.next
        follows = known and (message.boot > topic.boot or (message.boot == topic.boot and ahead >= 0))
        if not follows and topic.misfits >= _MISFITS and (known or message.t - topic.t > _SILENT_S):
            topic.writers[message.boot] = getattr(payload, "writer", b"")
            follows = True
        if follows:
            topic.boot, topic.next, topic.misfits, topic.t = message.boot, message.seq + 1, 0, message.t
            topic.first = 0
            return True
        topic.misfits += 1
        self._drop_misfit(key, topic, message, known)
        return False

    # Simulated time -------------------------------------------------------------------------------------

    def trust(self, writers: Mapping[str, Sequence[bytes]]) -> None:
        """Read only what these sessions publish: their marks by process, or "operator"."""
        self._trusted = {name: frozenset(writers.get(name, ())) for name in (*PROCESSES, "operator")}

    def resume(
        self,
        had: dict[str, int],
        visible: dict[str, int],
        kept: Mapping[str, Sequence[bytes]],
        inbox: Inbox,
    ) -> None:
        """Take the place of a reader that is gone.

        Args:
            had: how many messages of each topic it had read.
            visible: how many are visible now.
            kept: what the writers still have of each topic.
            inbox: gets the last message that reader had of each topic, not as a new one.
        """
        for key, topic in self._topics.items():
            seen = had.get(key, 0)
            self._place(key, topic, self._of_io(key, kept.get(key, ())), seen - 1)
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
                if not self._await_next(key, topic, wanted, inbox, timeout_s, ask):
                    lost = f"{key}: message {topic.next} of {wanted} did not arrive in {timeout_s:g} s"
                    topic.jump(min([wanted, *topic.early]))
                    self._take(key, topic, wanted, inbox)
            self._drop_strangers(key, topic)
        return lost

    def _await_next(
        self,
        key: str,
        topic: InputSequence,
        wanted: int,
        inbox: Inbox,
        timeout_s: float,
        ask: Ask,
    ) -> bool:
        """Wait for what is on its way, then ask for it; false if the next message is lost, whatever else comes."""
        missing = topic.next
        for asked, patience_s in ((False, _ON_ITS_WAY_S), (True, timeout_s)):
            if asked:
                if (kept := ask(key)) is None:
                    return True  # nothing is lost yet
                self._place(key, topic, self._of_io(key, kept), topic.next)
                self._take(key, topic, wanted, inbox)
                if topic.next > missing:
                    return True
            end = time.monotonic() + patience_s
            while self._wait(topic, end - time.monotonic()):
                self._sort(key, topic)
                self._take(key, topic, wanted, inbox)
                if topic.next > missing:
                    return True
        return False

    def _of_io(self, key: str, kept: Sequence[bytes]) -> list[bytes]:
        """Of what is kept of a topic, what io keeps: as good as from the topic's writer."""
        vouched = []
        for payload in kept:
            if self._trusted is None or getattr(payload, "writer", b"") in self._trusted["io"]:
                vouched.append(bytes(payload))
            else:
                self.drop(f"{key}: kept by a second publisher")
        return vouched

    def _take(self, key: str, topic: InputSequence, wanted: int, inbox: Inbox) -> None:
        """Hand over, in order and without a gap, what is here up to the count."""
        for message in topic.take(wanted):
            inbox.deliver(key, message)

    def _wait(self, topic: InputSequence, timeout_s: float) -> bool:
        """Until something has arrived; false when the time is up, whatever arrives."""
        with self._arrived:
            return timeout_s > 0.0 and self._arrived.wait_for(lambda: bool(topic.waiting), timeout_s)

    def _take_waiting(self, topic: InputSequence) -> list[bytes]:
        if not topic.waiting:
            return []
        with self._arrived:
            waiting, topic.waiting = topic.waiting, {}
        return [payload for queue in waiting.values() for payload in queue]

    def _place(self, key: str, topic: InputSequence, kept: Iterable[bytes], least: int) -> None:
        """Put what was kept for this reader in its place, from a sequence number on."""
        for payload in kept:
            message = self._decode(key, payload)
            if message is not None and message.seq >= least:
                there = topic.early.get(message.seq)
                if there is None or message.boot > there[0].boot:
                    topic.early[message.seq] = message, hash(payload)

    def _sort(self, key: str, topic: InputSequence) -> None:
        """Decode what has arrived and put each message in its place, if that is free."""
        payloads = self._take_waiting(topic)
        if topic.trusted is not self._trusted:
            topic.trusted = self._trusted
            payloads = [payload for _, payload in topic.strange] + payloads
            topic.strange.clear()
        for payload in payloads:
            message = self._decode(key, payload)
            if message is None:
                continue
            seq, mark = message.seq, hash(payload)
            there = topic.early.get(seq)
            if seq < topic.first:
                continue
            if not self._trusts(key, payload):
                topic.strange.append((message, payload))
            elif there is None and topic.next <= seq < topic.next + WINDOW:
                topic.early[seq] = message, mark
            elif there is not None and message.boot > there[0].boot:
                topic.early[seq] = message, mark  # the writer was restarted before its step was over
            elif seq < topic.next and message.boot > topic.boot:
                continue  # said before by a process that went when its step was over
            elif mark not in (topic.had.get(seq), there and there[1]):
                self._drop_misfit(key, topic, message, known=True)

    def _trusts(self, key: str, payload: bytes) -> bool:
        """Whether its writer may publish it; bytes without a mark did not come over the bus."""
        if self._trusted is None or not isinstance(payload, Marked):
            return True
        return payload.writer in self._trusted[TOPICS[key].writer]

    def _drop_strangers(self, key: str, topic: InputSequence) -> None:
        """Drop what is not, and will hardly be, of a process that the clock's master knows.

        One that has just come up may be heard before the release that tells of it.
        """
        kept: deque[tuple[Message, bytes]] = deque(maxlen=WINDOW)
        for message, payload in topic.strange:
            if topic.next <= message.seq < topic.next + WINDOW:
                kept.append((message, payload))
            else:
                self._drop_misfit(key, topic, message, known=False)
        topic.strange = kept

    def _decode(self, key: str, payload: bytes) -> Message | None:
        try:
            return decode(self._topics[key].kind, payload)
        except MessageError as error:
            self.drop(f"{key}: {error}")
            return None

    def _drop_misfit(self, key: str, topic: InputSequence, message: Message, known: bool) -> None:
        why = f"is out of place, next is {topic.next}: a second publisher?" if known else "is a second publisher's"
        self.drop(f"{key}: message {message.seq} {why}")

    def drop(self, why: str) -> None:
        """Count a bad message; `why` begins with its key."""
        self.bad += 1
        self.incidents.note(why.partition(":")[0], f"dropped {why}")
