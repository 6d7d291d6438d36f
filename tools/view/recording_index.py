"""Finds any instant of a recording without reading what lies before it."""

from __future__ import annotations

import mmap
import struct
from bisect import bisect_right
from collections.abc import Collection, Iterator
from functools import lru_cache
from io import BytesIO
from pathlib import Path
from typing import NamedTuple

import numpy as np
from mcap.data_stream import ReadDataStream
from mcap.opcode import Opcode
from mcap.records import Channel, Chunk
from mcap.stream_reader import breakup_chunk, get_chunk_data_stream

from surefoot.bus.codec import decode
from surefoot.bus.errors import RecordingError
from surefoot.bus.message import Message
from surefoot.bus.recording.reader import Recording
from surefoot.bus.recording.writer import DIGEST, message_type

_HEAD = struct.Struct("<BQ")  # of every record: what it is, and how long
_TIMES = struct.Struct("<QQ")  # a chunk begins with the times of its first and last message [ns]
_LIST_HEAD = struct.Struct("<HI")  # channel and bytes of a list of pairs: time [ns] and offset in the chunk
_MESSAGE_HEAD = 22  # bytes before a message's own
_MESSAGES_KEPT = 64
_CHUNKS_KEPT = 64
"""Unpacked, a quarter of a megabyte each: what a second of a run is read from."""


class _Place(NamedTuple):
    """Where the messages of one topic lie in one chunk."""

    chunk: int  # offset of the chunk's record in the file
    listing: int  # offset of the record that lists them
    length: int


class RecordingIndex:
    """The chunks of a recording by topic and time, found by leaping from record to record.

    A recording that was cut off has no list of its chunks at its end; so none is relied on.

    Attributes:
        recording: what the file says of itself.
        begin_t, end_t: the run's time of the first and the last message [s].
        damage: in words how the file ends too early; empty if it does not.
    """

    def __init__(self, path: Path):
        """Leap once through the file.

        Raises:
            RecordingError: there is no such file, or it is no recording.
        """
        self.recording = Recording(path)
        self.damage = "it was not closed"
        with path.open("rb") as file:
            self._bytes = mmap.mmap(file.fileno(), 0, access=mmap.ACCESS_READ)
        self._places: dict[str, list[_Place]] = {}
        self._begins: dict[str, list[int]] = {}  # time of the first message in each of these places [ns]
        self._keys: dict[int, str] = {}
        first_ns, last_ns = self._leap()
        self.begin_t, self.end_t = first_ns / 1e9, last_ns / 1e9
        self._unpacked = lru_cache(_CHUNKS_KEPT)(self._unpack)
        self._listed = lru_cache(8 * _CHUNKS_KEPT)(self._list)
        self._newest = lru_cache(_MESSAGES_KEPT)(self._read)

    @property
    def keys(self) -> Collection[str]:
        """Topics of which there are messages, not only digests."""
        return self._places.keys()

    def newest(self, key: str, t: float) -> Message | None:
        """The last message of a topic at or before a time [s], the same object as long as it is; None before all.

        Raises:
            RecordingError: what lies there cannot be read.
        """
        t_ns = round(t * 1e9)
        places = self._places.get(key, [])
        number = bisect_right(self._begins.get(key, []), t_ns) - 1
        if number < 0:
            return None
        times, offsets = self._listed(places[number])
        last = int(np.searchsorted(times, t_ns, side="right")) - 1
        return self._newest(key, places[number], int(offsets[max(last, 0)]))

    def messages(self, key: str) -> Iterator[Message]:
        """All messages of a topic in the order of the file.

        Raises:
            RecordingError: some of them cannot be read.
        """
        for place in self._places.get(key, []):
            for offset in self._listed(place)[1].tolist():
                yield self._read(key, place, offset)

    def _leap(self) -> tuple[int, int]:
        """Note where the chunks lie; times of the first and the last message [ns]."""
        data, position, chunk = self._bytes, 8, 0
        spans: list[tuple[int, int]] = []
        while position + _HEAD.size <= len(data):
            opcode, length = _HEAD.unpack_from(data, position)
            content = position + _HEAD.size
            if content + length > len(data):
                self.damage = "it ends in the middle of a record"
                break
            if opcode == Opcode.CHUNK:
                chunk = position
                spans.append(_TIMES.unpack_from(data, content))
            elif opcode == Opcode.MESSAGE_INDEX and length >= _LIST_HEAD.size + _TIMES.size:
                self._note(_Place(chunk, content, length))
            elif opcode == Opcode.FOOTER:
                self.damage = ""
            position = content + length
        if not spans:
            return 0, 0
        return min(begin for begin, _ in spans), max(end for _, end in spans)

    def _note(self, place: _Place) -> None:
        channel, _ = _LIST_HEAD.unpack_from(self._bytes, place.listing)
        if channel not in self._keys:
            self._name_channels(place.chunk)
        if key := self._keys.get(channel, ""):
            first_ns, _ = _TIMES.unpack_from(self._bytes, place.listing + _LIST_HEAD.size)
            self._places.setdefault(key, []).append(place)
            self._begins.setdefault(key, []).append(first_ns)

    def _name_channels(self, chunk: int) -> None:
        """A channel is named in the first chunk that has messages of it."""
        for record in breakup_chunk(self._chunk(chunk)):
            if isinstance(record, Channel):
                self._keys[record.id] = "" if record.message_encoding == DIGEST else record.topic

    def _chunk(self, offset: int) -> Chunk:
        _, length = _HEAD.unpack_from(self._bytes, offset)
        begin = offset + _HEAD.size
        return Chunk.read(ReadDataStream(BytesIO(self._bytes[begin : begin + length])))

    def _unpack(self, chunk: int) -> bytes:
        try:
            stream, length = get_chunk_data_stream(self._chunk(chunk))
            return stream.read(length)
        except Exception as error:  # whatever a decompressor says of half a record
            raise RecordingError(f"{self.recording.path}: a part cannot be read ({error})") from None

    def _list(self, place: _Place) -> tuple[np.ndarray, np.ndarray]:
        """Times [ns] of one topic's messages in a chunk and their offsets in it."""
        listed = self._bytes[place.listing + _LIST_HEAD.size : place.listing + place.length]
        pairs = np.frombuffer(listed, "<u8").reshape(-1, 2)
        return pairs[:, 0], pairs[:, 1]

    def _read(self, key: str, place: _Place, offset: int) -> Message:
        data = self._unpacked(place.chunk)
        _, length = _HEAD.unpack_from(data, offset)
        begin = offset + _HEAD.size
        return decode(message_type(key), data[begin + _MESSAGE_HEAD : begin + length])
