"""Reads a recording, also one that was cut off in the middle or made by an earlier version."""

from __future__ import annotations

import json
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from mcap.records import Channel, Footer, McapRecord, Message, Metadata
from mcap.stream_reader import StreamReader

from surefoot.bus.errors import RecordingError
from surefoot.bus.recording.writer import ABOUT, BATCH, DIGEST


@dataclass(frozen=True)
class Recorded:
    """One message of a recording.

    Attributes:
        key: of the topic, or of a process's log.
        t_ns: when it was published, on the run's clock [ns].
        seq: its number on this topic.
        payload: the bytes that were on the bus, or a digest of them.
        digest: it is a digest.
    """

    key: str
    t_ns: int
    seq: int
    payload: bytes
    digest: bool = False


class Recording:
    """A recording on disk; iterating it gives its messages in the order in which they were written.

    Attributes:
        path: of the file.
        about: what was recorded: versions, time, configuration.
        journals: of every start of a process how its journal ended; empty if the file was not closed.
        damage: after an iteration, in words how the file ends too early; empty if it does not.
    """

    def __init__(self, path: Path):
        """Read what the file says of itself.

        Raises:
            RecordingError: there is no such file, or it is no recording of this project.
        """
        self.path = path
        self.about: dict[str, str] = {}
        self.journals: list[dict[str, Any]] = []
        self.damage = ""
        for record in self._records():
            if isinstance(record, Metadata) and record.name == ABOUT:
                self.about = record.metadata
                return
        raise RecordingError(f"{path}: not a recording of `surefoot run --record` ({self.damage or 'other MCAP'})")

    @property
    def config(self) -> dict[str, Any]:
        """The resolved configuration as tables."""
        return json.loads(self.about["config"])

    def __iter__(self) -> Iterator[Recorded]:
        channels: dict[int, Channel] = {}
        self.journals = []
        for record in self._records():
            if isinstance(record, Message):
                channel = channels.get(record.channel_id)
                if channel is None:
                    self.damage = "it holds messages of a topic that it does not name"
                    return
                digest = channel.message_encoding == DIGEST
                yield Recorded(channel.topic, record.log_time, record.sequence, record.data, digest)
            elif isinstance(record, Channel):
                channels[record.id] = record
            elif isinstance(record, Metadata) and record.name == BATCH:
                try:
                    self.journals.append(journal_end(record))
                except ValueError:
                    self.damage = "what it says of its journals cannot be read"
                    return

    def _records(self) -> Iterator[McapRecord]:
        """Every record up to the end, or to where the file is cut off."""
        self.damage = "it was not closed"
        try:
            with self.path.open("rb") as file:
                for record in StreamReader(file, validate_crcs=True, record_size_limit=1 << 30).records:
                    if isinstance(record, Footer):
                        self.damage = ""
                    yield record
        except FileNotFoundError:
            raise RecordingError(f"no such file: {self.path}") from None
        except IsADirectoryError:
            raise RecordingError(f"{self.path} is a folder, not a recording") from None
        except Exception as error:  # whatever a parser or a decompressor says of half a record
            self.damage = f"it ends in the middle of a record ({type(error).__name__}: {error})"


def journal_end(record: Metadata) -> dict[str, Any]:
    """How far one start of a process noted what it did, and whether its journal has an end.

    Raises:
        ValueError: it is no record of that.
    """
    return {name: json.loads(value) for name, value in record.metadata.items()}
