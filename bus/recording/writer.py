"""Writes a recording: one MCAP file, one channel a topic."""

from __future__ import annotations

import json
from collections.abc import Mapping
from contextlib import suppress
from pathlib import Path
from typing import Any

from mcap.writer import CompressionType, Writer

from surefoot.bus.message import Message
from surefoot.bus.recording.journal import Batch, Record
from surefoot.bus.recording.json_schema import json_schema
from surefoot.bus.recording.step_log import CHECKPOINT, STEPS, Checkpoint, StepLog
from surefoot.bus.topics import TOPICS

ENCODING, DIGEST = "msgpack", "blake2b-8"
"""Of a channel: the messages as they were on the bus, or only a digest of each (in clips)."""

ABOUT = "surefoot"
"""Name of the metadata record that says what was recorded."""

BATCH = "batch"
"""Name of the metadata records at the end, one for every start of a process: how far its journal goes."""

_CHUNK_BYTES = 1 << 18


def message_type(key: str) -> type[Message]:
    """What travels under a key of a recording.

    Raises:
        KeyError: neither a topic nor a process's log.
    """
    prefix = key.partition("/")[0]
    if prefix == STEPS:
        return StepLog
    if prefix == CHECKPOINT:
        return Checkpoint
    return TOPICS[key].message


class RecordingWriter:
    """An MCAP file that grows by batches.

    What was flushed is there whatever happens to this process; a file that was not closed has no index, and is
    read all the same.
    """

    def __init__(self, path: Path, about: Mapping[str, str], small: bool = False):
        """Create the file.

        Args:
            path: is overwritten.
            about: what was recorded: the resolved configuration as JSON, versions.
            small: smaller by a tenth for four times the processor time: for what is kept, not beside a robot.

        Raises:
            OSError: the file cannot be written.
        """
        self._file = path.open("wb")
        compression = CompressionType.ZSTD if small else CompressionType.LZ4
        self._writer = Writer(self._file, chunk_size=_CHUNK_BYTES, compression=compression)
        self._writer.start("surefoot", "surefoot")
        self._writer.add_metadata(ABOUT, dict(about))
        self._channels: dict[tuple[str, str], int] = {}
        self._schemas: dict[type[Message], int] = {}
        self._next: dict[tuple[str, int], Batch] = {}
        self.flush()

    def add(self, batch: Batch) -> None:
        """Append a batch.

        Raises:
            OSError: it cannot be written; what was flushed before stands.
        """
        for record in batch.records:
            self.add_record(record)
        self._next[batch.process, batch.boot] = batch

    def add_record(self, record: Record, encoding: str = ENCODING) -> None:
        """Append one record."""
        key, t_ns, seq, payload = record
        channel = self._channels.get((key, encoding))
        if channel is None:
            channel = self._channels[key, encoding] = self._channel(key, encoding)
        self._writer.add_message(channel, t_ns, payload, t_ns, seq & 0xFFFFFFFF)

    def flush(self) -> None:
        """Hand all to the operating system."""
        self._writer.flush()

    def close(self) -> None:
        """Write the index and close."""
        try:
            for (process, boot), batch in self._next.items():
                entry: dict[str, Any] = {"process": process, "boot": boot, "batches": batch.number + 1}
                self._writer.add_metadata(
                    BATCH, {name: json.dumps(value) for name, value in (entry | {"ended": batch.last}).items()}
                )
            self._writer.finish()
        finally:
            self._file.close()

    def abandon(self) -> None:
        """Close without an index, after an error."""
        with suppress(OSError):  # what is still in its buffer cannot be written either
            self._file.close()

    def _channel(self, key: str, encoding: str) -> int:
        kind = message_type(key)
        if kind not in self._schemas:
            self._schemas[kind] = self._writer.register_schema(kind.__name__, "jsonschema", json_schema(kind))
        return self._writer.register_channel(key, encoding, self._schemas[kind])
