"""Where in a recording the messages of each topic lie: to read one topic without the others."""

from __future__ import annotations

import io
import os
import struct
from collections import Counter
from collections.abc import Collection, Iterator
from dataclasses import dataclass, field
from functools import cached_property
from pathlib import Path
from typing import Any, BinaryIO

from mcap.data_stream import ReadDataStream
from mcap.opcode import Opcode
from mcap.reader import make_reader
from mcap.records import Channel, Chunk
from mcap.stream_reader import breakup_chunk, get_chunk_data_stream

from surefoot.bus.errors import RecordingError
from surefoot.bus.recording.reader import Recorded, Recording, journal_end
from surefoot.bus.recording.writer import BATCH, DIGEST

_HEAD = struct.Struct("<BQ")
"""Of a record: its kind and the length of what follows."""

_MESSAGE = struct.Struct("<HIQQ")
"""Of a message: channel, number, time, time of publication; the bytes follow."""

_SPAN, _INDEX = struct.Struct("<QQ"), struct.Struct("<HI")
"""What a part of the file begins with: times of its messages; and its index: channel, bytes of entries."""

_ENTRY_BYTES = 16  # of an index: a time and a place
_MAGIC_BYTES = 8
_ALL = range(1 << 16)  # channels that a file can have


@dataclass(frozen=True, eq=False)
class Part:
    """Some successive messages of the file, compressed together.

    Attributes:
        offset: of its record in the file.
        first_ns, last_ns: times of its messages [ns].
        channels: of these there are messages in it.
    """

    offset: int
    first_ns: int
    last_ns: int
    channels: set[int]


@dataclass
class _Map:
    """What is known of a file before a message is read: channels by number, parts, messages of each channel."""

    channels: dict[int, Channel] = field(default_factory=dict)
    parts: list[Part] = field(default_factory=list)
    counts: Counter[int] = field(default_factory=Counter)


class RecordingIndex:
    """A recording on disk, by topic.

    A file that was closed tells where its messages are. One that was not is looked through once, from part to
    part, without unpacking them; it ends where the last whole part does.

    Attributes:
        recording: what the file says of itself.
        damage: in words how the file ends too early; empty if it does not.
    """

    def __init__(self, path: Path):
        """Find out what lies where.

        Raises:
            RecordingError: there is no such file, or it is no recording of this project.
        """
        self.recording = Recording(path)
        self.damage = ""
        with path.open("rb") as file:
            self._map = self._told(file) or self._looked_through(file)

    @property
    def path(self) -> Path:
        """Of the file."""
        return self.recording.path

    @cached_property
    def counts(self) -> dict[str, int]:
        """How many messages of each topic are there; of some there may be digests only."""
        return self._counts(digests=False)

    @cached_property
    def digests(self) -> dict[str, int]:
        """How many digests of each topic are there: of clips, instead of messages."""
        return self._counts(digests=True)

    @property
    def span_ns(self) -> tuple[int, int]:
        """Times of the first and the last message [ns]; zeros without any."""
        parts = self._map.parts
        return min((each.first_ns for each in parts), default=0), max((each.last_ns for each in parts), default=0)

    def journals(self) -> list[dict[str, Any]]:
        """Of every start of a process how its journal ended; empty if the file was not closed."""
        if self.damage:
            return []
        with self.path.open("rb") as file:
            return [journal_end(each) for each in make_reader(file).iter_metadata() if each.name == BATCH]

    def messages(self, *keys: str, first_ns: int = 0, last_ns: int = 1 << 63) -> Iterator[Recorded]:
        """The messages of some topics between two times [ns], in the order in which they were written.

        Where the file is damaged they end, and `damage` says so.
        """
        wanted, parts = self._topics(*keys), self.parts(*keys)
        with self.path.open("rb") as file:
            if 2 * len(parts) < len(self._map.parts):  # else the system reads ahead what lies between them
                os.posix_fadvise(file.fileno(), 0, 0, os.POSIX_FADV_RANDOM)
            for part in parts:
                if part.last_ns < first_ns or part.first_ns > last_ns:
                    continue
                try:
                    data = _unpacked(file, part)
                except Exception as error:  # whatever a decompressor says of bytes that were changed
                    begin = part.first_ns / 1e9
                    self.damage = f"it cannot be read from {begin:.3f} s on ({type(error).__name__}: {error})"
                    return
                for number, seq, t_ns, payload in _messages(data, wanted):
                    if first_ns <= t_ns <= last_ns:
                        yield Recorded(wanted[number], t_ns, seq, payload)

    def parts(self, *keys: str) -> list[Part]:
        """Where messages of some topics are, in the order in which they were written."""
        wanted = self._topics(*keys).keys()
        return [part for part in self._map.parts if not wanted.isdisjoint(part.channels)]

    def unpack(self, part: Part) -> list[Recorded]:
        """All messages of a part, but for digests.

        Raises:
            RecordingError: it cannot be read.
        """
        topics = self._topics(*self.counts)
        try:
            with self.path.open("rb") as file:
                data = _unpacked(file, part)
        except Exception as error:  # whatever a decompressor says of bytes that were changed
            raise RecordingError(f"{self.path}: a part cannot be read ({error})") from None
        return [Recorded(topics[n], t_ns, seq, payload) for n, seq, t_ns, payload in _messages(data, topics)]

    # How it is found ------------------------------------------------------------------------------------

    def _topics(self, *keys: str) -> dict[int, str]:
        """Channels that hold the messages of some topics, and of which."""
        return {
            number: channel.topic
            for number, channel in self._map.channels.items()
            if channel.topic in keys and channel.message_encoding != DIGEST
        }

    def _counts(self, digests: bool) -> dict[str, int]:
        found: Counter[str] = Counter()
        for number, channel in self._map.channels.items():
            if (channel.message_encoding == DIGEST) == digests and self._map.counts[number]:
                found[channel.topic] += self._map.counts[number]
        return dict(found)

    def _told(self, file: BinaryIO) -> _Map | None:
        """What the end of a closed file says; None where there is no such end."""
        try:
            summary = make_reader(file).get_summary()
        except Exception:  # half a file gives almost any kind of error
            return None
        if summary is None or summary.statistics is None:
            return None
        parts = [
            Part(at.chunk_start_offset, at.message_start_time, at.message_end_time, set(at.message_index_offsets))
            for at in summary.chunk_indexes
        ]
        return _Map(summary.channels, parts, Counter(summary.statistics.channel_message_counts))

    def _looked_through(self, file: BinaryIO) -> _Map:
        """The same of a file that was cut off: from record to record, without unpacking them."""
        self.damage = "it was not closed"
        size, seen = file.seek(0, io.SEEK_END), _Map()
        at = file.seek(_MAGIC_BYTES)
        while at + _HEAD.size <= size:
            kind, length = _HEAD.unpack(file.read(_HEAD.size))
            after = at + _HEAD.size + length
            if after > size:
                self.damage = "it ends in the middle of a record"
                break
            if kind == Opcode.CHUNK:
                first_ns, last_ns = _SPAN.unpack(file.read(_SPAN.size))
                seen.parts.append(Part(at, first_ns, last_ns, set()))
            elif kind == Opcode.MESSAGE_INDEX and seen.parts:
                channel, entries = _INDEX.unpack(file.read(_INDEX.size))
                self._note(file, seen, channel, entries // _ENTRY_BYTES)
            at = file.seek(after)
        if seen.parts:
            self._note_last(file, seen)
        return seen

    def _note(self, file: BinaryIO, seen: _Map, channel: int, count: int) -> None:
        """Take in how many messages of a channel the latest part holds; a channel is named in its first part."""
        seen.parts[-1].channels.add(channel)
        seen.counts[channel] += count
        if channel not in seen.channels:
            named = breakup_chunk(_chunk(file, seen.parts[-1]))
            seen.channels |= {each.id: each for each in named if isinstance(each, Channel)}

    def _note_last(self, file: BinaryIO, seen: _Map) -> None:
        """The last part may have lost the end of its index."""
        last = seen.parts[-1]
        try:
            found = Counter(channel for channel, *_ in _messages(_unpacked(file, last), _ALL))
        except Exception:  # as when reading: there it is told
            return
        for channel in found.keys() - last.channels:
            self._note(file, seen, channel, found[channel])


def _chunk(file: BinaryIO, part: Part) -> Chunk:
    file.seek(part.offset + _HEAD.size)
    return Chunk.read(ReadDataStream(file))


def _unpacked(file: BinaryIO, part: Part) -> bytes:
    stream, size = get_chunk_data_stream(_chunk(file, part), validate_crc=True)
    return stream.read(size)


def _messages(data: bytes, wanted: Collection[int]) -> Iterator[tuple[int, int, int, bytes]]:
    """Channel, number, time [ns] and bytes of each message of some channels in an unpacked part."""
    at = 0
    while at < len(data):
        kind, length = _HEAD.unpack_from(data, at)
        at += _HEAD.size
        if kind == Opcode.MESSAGE:
            channel, seq, t_ns, _ = _MESSAGE.unpack_from(data, at)
            if channel in wanted:
                yield channel, seq, t_ns, data[at + _MESSAGE.size : at + length]
        at += length
