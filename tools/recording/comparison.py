"""What a replay published, against what the recording holds."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

from surefoot.bus.codec import decode
from surefoot.bus.message import Message
from surefoot.bus.recording.reader import Recorded
from surefoot.bus.recording.writer import message_type
from surefoot.tools.recording.difference import canonical, digest, first_difference
from surefoot.tools.recording.track import MessageId


@dataclass
class TopicComparison:
    """One topic.

    Attributes:
        compared: messages that both have.
        differing: of these, how many differ.
        missing: recorded, but not published now.
        extra: published now, but not recorded.
        unread: of these only a digest was recorded, which says nothing on a machine of other arithmetic.
        first: where and how they differ first, in words; empty if they do not.
    """

    compared: int = 0
    differing: int = 0
    missing: int = 0
    extra: int = 0
    unread: int = 0
    first: str = ""

    @property
    def equal(self) -> bool:
        """Not a byte differs."""
        return not (self.differing or self.missing or self.extra)


class Comparison:
    """Compares message by message as a replay goes on.

    Attributes:
        topics: by key.
    """

    def __init__(self, recorded: Mapping[MessageId, Recorded], tolerance: float = 0.0):
        """Nothing is compared yet.

        Args:
            recorded: all that the recording holds of the topics to compare.
            tolerance: 0 asks for equal bytes; otherwise as in `first_difference`.
        """
        self._recorded, self._tolerance = recorded, tolerance
        self._seen: set[MessageId] = set()
        self._newest: dict[tuple[str, int], int] = {}
        for each in recorded:
            newest = self._newest.get((each.key, each.boot), -1)
            self._newest[each.key, each.boot] = max(newest, each.seq)
        self.topics: dict[str, TopicComparison] = {}

    @property
    def equal(self) -> bool:
        """Everything that was compared is equal, and something was."""
        return bool(self.topics) and all(topic.equal for topic in self.topics.values())

    def note(self, t: float, key: str, message: Message, last: bool) -> None:
        """A message published now in the step at time `t` [s], the `last` recorded one of its process or not."""
        topic = self.topics.setdefault(key, TopicComparison())
        at = MessageId(key, message.boot, message.seq)
        self._seen.add(at)
        there = self._recorded.get(at)
        if there is None:
            if last or message.seq <= self._newest.get((key, message.boot), -1):
                return  # the recording ended before it was published, or has lost it
            topic.extra += 1
            topic.first = topic.first or f"message {message.seq} at {t:.3f} s: not recorded"
            return
        if there.digest and self._tolerance:
            topic.unread += 1
            return
        topic.compared += 1
        words = self._difference(key, there, message)
        if words:
            topic.differing += 1
            topic.first = topic.first or f"message {message.seq} at {t:.3f} s: {words}"

    def _difference(self, key: str, there: Recorded, message: Message) -> str:
        if there.digest:
            return "" if there.payload == digest(message) else "the digest differs (only that was recorded)"
        recorded = decode(message_type(key), there.payload)
        if canonical(recorded) == canonical(message):
            return ""
        return first_difference(recorded, message, self._tolerance)

    def finish(self, key: str, boot: int, first_seq: int, until_t_ns: int) -> None:
        """The replay of a topic's writer is over: what it should have published up to then and has not."""
        topic = self.topics.setdefault(key, TopicComparison())
        for at, there in self._recorded.items():
            due = at.key == key and at.boot == boot and at.seq >= first_seq and there.t_ns <= until_t_ns
            if due and at not in self._seen:
                topic.missing += 1
                topic.first = topic.first or f"message {at.seq} at {there.t_ns / 1e9:.3f} s: not published now"
