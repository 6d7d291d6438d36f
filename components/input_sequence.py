"""What has arrived of one input and was not taken yet."""

from __future__ import annotations

from collections import deque
from collections.abc import Iterator

from surefoot.bus.message import Message
from surefoot.bus.topics import TOPICS

KEPT = 32
"""Messages of a topic that its writer keeps for a reader that comes late, or again."""

WINDOW = 256
"""Messages wait for a reader at the most; a number further ahead than this is not the writer's."""

_WRITERS = 8  # of one topic are listened to between two steps


class InputSequence:
    """Bytes not yet decoded, messages not yet visible, and where the writer's numbers stand.

    Attributes:
        kind: of the messages.
        waiting: bytes that have arrived since the last step, by writer.
        early: messages by number that are not visible yet, each with a mark of its bytes.
        had: marks of the last ones that were taken, by number.
        writers: the session heard first of each boot.
        strange: what came from a session that is not trusted, or not yet.
        trusted: who was when `strange` was looked through.
        arrivals: messages that have arrived in all.
        first, next: number of the first message of interest, and of the next one to be taken.
        misfits: messages out of sequence since the last that was in it.
        boot, t: of the last message taken.
    """

    def __init__(self, key: str):
        """For the topic `key`."""
        self.kind = TOPICS[key].message
        self.waiting: dict[bytes, deque[bytes]] = {}
        self.early: dict[int, tuple[Message, int]] = {}
        self.had: dict[int, int] = {}
        self.writers: dict[int, bytes] = {}
        self.strange: deque[tuple[Message, bytes]] = deque()
        self.trusted: dict[str, frozenset[bytes]] | None = None
        self.arrivals = self.first = self.next = self.misfits = 0
        self.boot, self.t = -1, 0.0

    def store(self, payload: bytes) -> None:
        """Keep bytes until the next step; each writer has room of its own, whatever the others send."""
        writer = getattr(payload, "writer", b"")
        if writer in self.waiting or len(self.waiting) < _WRITERS:
            self.waiting.setdefault(writer, deque(maxlen=WINDOW)).append(payload)
        self.arrivals += 1

    def jump(self, seq: int) -> None:
        """Read on from a sequence number; what lies before it is of no interest."""
        self.first = self.next = seq
        for old in [each for each in self.early if each < seq]:
            del self.early[old]

    def is_of_writer(self, message: Message, payload: bytes) -> bool:
        """Whether the session that was heard first of this boot has sent it."""
        writer = getattr(payload, "writer", b"")
        return self.writers.setdefault(message.boot, writer) == writer

    def take(self, wanted: int) -> Iterator[Message]:
        """The messages that are here, in order and without a gap, with numbers below `wanted`; each once."""
        while self.next < wanted and self.next in self.early:
            message, self.had[self.next] = self.early.pop(self.next)
            self.boot = max(self.boot, message.boot)
            self.had.pop(self.next - KEPT, None)
            self.next += 1
            yield message
