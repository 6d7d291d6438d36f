"""A recording as tables: each topic is decoded when it is first asked for."""

from __future__ import annotations

import heapq
import json
from collections.abc import Collection, Iterator, Mapping, Sequence
from functools import cached_property
from os import PathLike
from pathlib import Path
from typing import TYPE_CHECKING, Any

from surefoot.bus.codec import decode
from surefoot.bus.message import Message, specs
from surefoot.bus.recording.index import RecordingIndex
from surefoot.bus.recording.reader import Recorded
from surefoot.bus.recording.step_log import CHECKPOINT, STEPS
from surefoot.bus.recording.writer import message_type
from surefoot.bus.topics import TOPICS
from surefoot.tools.tables.columns import columns
from surefoot.tools.tables.table import NotRecorded, Table

if TYPE_CHECKING:
    import pandas

    from surefoot.config.deployment import Deployment

_ALWAYS = ("t", "seq", "boot", "valid")


def load(path: str | PathLike[str]) -> RecordingTables:
    """Open a recording of `surefoot run --record`, `surefoot record` or `surefoot eval --record`.

    Args:
        path: of the `.mcap` file; one that was cut off is read as far as it goes.

    Raises:
        RecordingError: there is no such file, or it is no recording.
    """
    return RecordingTables(Path(path))


class RecordingTables(Mapping[str, Table]):
    """The topics of a recording by key: `recording["state/estimate"]["p_WB"]`.

    A topic is decoded when it is first asked for, and kept. Of a topic too large for that, such as the policies of
    the MPC (36 kB each), `read` takes some fields or a stretch of time.
    """

    def __init__(self, path: Path):
        self._index = RecordingIndex(path)
        self._tables: dict[str, Table] = {}
        self._skipped: dict[str, int] = {}

    # What there is --------------------------------------------------------------------------------------

    def __iter__(self) -> Iterator[str]:
        return (key for key in TOPICS if key in self._index.counts)

    def __len__(self) -> int:
        return sum(1 for _ in self)

    def __contains__(self, key: object) -> bool:
        return key in TOPICS and key in self._index.counts

    def __getitem__(self, key: str) -> Table:
        """All of a topic.

        Raises:
            NotRecorded: there is nothing of it; the message lists the topics that are there.
            MessageError: a message of it is not as declared.
        """
        if key not in self._tables:
            self._tables[key] = self.read(key)
        return self._tables[key]

    def __repr__(self) -> str:
        begin, end = self.span_s
        return f"<recording {self.path}, {begin:.3f} to {end:.3f} s: {', '.join(self)}>"

    @property
    def path(self) -> Path:
        """Of the file."""
        return self._index.path

    @property
    def counts(self) -> dict[str, int]:
        """Messages of each topic."""
        return {key: self._index.counts[key] for key in self}

    @property
    def span_s(self) -> tuple[float, float]:
        """Times of the first and the last message on the run's clock [s]."""
        begin, end = self._index.span_ns
        return begin / 1e9, end / 1e9

    @property
    def config(self) -> dict[str, Any]:
        """The configuration of the run, resolved, as tables."""
        return json.loads(self._index.recording.about["config"])

    @property
    def versions(self) -> dict[str, str]:
        """What the recording was made by: version, digest of the sources and of the arithmetic, date, how."""
        return {name: text for name, text in self._index.recording.about.items() if name != "config"}

    @cached_property
    def deployment(self) -> Deployment:
        """The configuration as this version knows it.

        Raises:
            ConfigError: this version cannot be configured so.
        """
        from surefoot.tools.recording.replay import recorded_deployment

        return recorded_deployment(self._index.recording)[0]

    @property
    def missing(self) -> list[str]:
        """In words what is missing: of the file, of journals, and of the topics that were read until now."""
        found = [f"the file is incomplete: {self._index.damage}"] if self._index.damage else []
        found += [
            f"{entry['process']}: its journal after {entry['boot']} restarts has no end"
            for entry in self._index.journals()
            if not entry["ended"]
        ]
        found += [f"{key}: only digests of {count} messages" for key, count in self._index.digests.items()]
        return found + [f"{key}: {count} messages are missing" for key, count in self._skipped.items()]

    # What is in it --------------------------------------------------------------------------------------

    def read(
        self,
        key: str,
        fields: Sequence[str] = (),
        begin_s: float = float("-inf"),
        end_s: float = float("inf"),
    ) -> Table:
        """Some fields of a topic, in a stretch of the run's time, ends included.

        Args:
            key: of the topic; `steps/NAME` and `checkpoint/NAME` are there too.
            fields: names; all when not given. The header `t`, `seq`, `boot`, `valid` comes with them.
            begin_s, end_s: times of publication [s].

        Raises:
            NotRecorded: there is no such topic or field.
            MessageError: a message of it is not as declared.
        """
        message = self._type(key)
        known = specs(message)
        for field in fields:
            if field not in known:
                raise NotRecorded(f"{key}: no field {field!r}; a {message.__name__} has {', '.join(known)}")
        wanted = [name for name in known if not fields or name in fields or name in _ALWAYS]
        items = self._items(key, begin_s, end_s)
        table = Table(key, message, columns(message, (item.payload for item in items), wanted))
        if table.missing:
            self._skipped[key] = max(table.missing, self._skipped.get(key, 0))
        return table

    def messages(
        self, keys: Collection[str], begin_s: float = float("-inf"), end_s: float = float("inf")
    ) -> Iterator[tuple[str, Message]]:
        """(key, message) of some topics in the order of their publication, for listeners of a run.

        Topics that were not recorded are left out.
        """
        there = [key for key in TOPICS if key in keys and key in self]
        streams = [sorted(self._items(key, begin_s, end_s), key=lambda item: item.t_ns) for key in there]
        for item in heapq.merge(*streams, key=lambda item: item.t_ns):
            yield item.key, decode(TOPICS[item.key].message, item.payload)

    def pandas(self, key: str) -> pandas.DataFrame:
        """A topic as a data frame: one column for each number, `p_WF_FL_x`, time as the index.

        Raises:
            NotRecorded: there is no such topic.
            ConfigError: pandas is not installed.
        """
        return self[key].pandas()

    def _type(self, key: str) -> type[Message]:
        if key not in self._index.counts:
            if key in self._index.digests:
                raise NotRecorded(f"{self.path}: of {key!r} only digests were kept, it is a clip of a recording")
            raise NotRecorded(f"{self.path}: no topic {key!r} in it; there are {', '.join(self)}")
        if key not in TOPICS and key.partition("/")[0] not in (STEPS, CHECKPOINT):
            raise NotRecorded(f"{self.path}: topic {key!r} is of another version, which this one cannot read")
        return message_type(key)

    def _items(self, key: str, begin_s: float, end_s: float) -> Iterator[Recorded]:
        first = 0 if begin_s <= 0.0 else round(begin_s * 1e9)
        last = 1 << 63 if end_s == float("inf") else round(end_s * 1e9)
        return self._index.messages(key, first_ns=first, last_ns=last)
