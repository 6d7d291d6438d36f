"""Finds any instant of a recording without reading what lies before it."""

from __future__ import annotations

from bisect import bisect_right
from collections.abc import Collection
from functools import lru_cache
from itertools import accumulate
from operator import attrgetter
from pathlib import Path

from surefoot.bus.codec import decode
from surefoot.bus.message import Message
from surefoot.bus.recording import index
from surefoot.bus.recording.reader import Recorded
from surefoot.bus.recording.writer import message_type

_MESSAGES_KEPT = 64
_PARTS_KEPT = 64
"""Unpacked, a quarter of a megabyte each: what a second of a run is read from."""


class RecordingIndex:
    """The newest message of each topic at any time.

    Attributes:
        recording: what the file says of itself.
        begin_t, end_t: the run's time of the first and the last message [s].
    """

    def __init__(self, path: Path):
        """Find out what lies where.

        Raises:
            RecordingError: there is no such file, or it is no recording.
        """
        self._index = index.RecordingIndex(path)
        self.recording = self._index.recording
        first_ns, last_ns = self._index.span_ns
        self.begin_t, self.end_t = first_ns / 1e9, last_ns / 1e9
        self._parts = {key: self._index.parts(key) for key in self._index.counts}
        self._begins = {key: _earliest_from(parts) for key, parts in self._parts.items()}
        self._held = lru_cache(_PARTS_KEPT)(self._hold)
        self._decoded = lru_cache(_MESSAGES_KEPT)(_decode)

    @property
    def damage(self) -> str:
        """In words how the file ends too early; empty if it does not."""
        return self._index.damage

    @property
    def keys(self) -> Collection[str]:
        """Topics of which there are messages, not only digests."""
        return self._parts.keys()

    def newest(self, key: str, t: float) -> Message | None:
        """The last message of a topic at or before a time [s], the same object as long as it is; None before all.

        Raises:
            RecordingError: what lies there cannot be read.
        """
        t_ns = _ns(t)
        for number in reversed(range(bisect_right(self._begins.get(key, []), t_ns))):
            there = self._held(self._parts[key][number]).get(key, [])
            if place := bisect_right(there, t_ns, key=attrgetter("t_ns")):
                return self._decoded(there[place - 1])
        return None

    def messages(self, *keys: str, after_t: float, until_t: float) -> list[tuple[float, Message]]:
        """By time, with its time, each message of some topics that was published after one until another [s].

        Where the file is damaged they end, and `damage` says so.
        """
        items = self._index.messages(*keys, first_ns=_ns(after_t) + 1, last_ns=_ns(until_t))
        return [(item.t_ns / 1e9, _decode(item)) for item in sorted(items, key=attrgetter("t_ns"))]

    def _hold(self, part: index.Part) -> dict[str, list[Recorded]]:
        """The messages of a part by topic."""
        found: dict[str, list[Recorded]] = {}
        for item in self._index.unpack(part):
            found.setdefault(item.key, []).append(item)
        return found


def _earliest_from(parts: list[index.Part]) -> list[int]:
    """Of each part the first time in it or in a later one [ns]; processes hand in what they did at other times."""
    firsts = (part.first_ns for part in reversed(parts))
    return list(accumulate(firsts, min))[::-1]


def _ns(t: float) -> int:
    return round(t * 1e9)


def _decode(item: Recorded) -> Message:
    return decode(message_type(item.key), item.payload)
