"""One topic of a recording: an array for each field, the first axis is time."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from typing import TYPE_CHECKING

import numpy as np

from surefoot.bus.errors import RecordingError
from surefoot.bus.message import FieldSpec, Message, specs
from surefoot.config.typed_toml import ConfigError
from surefoot.tools.tables.column_names import column_names

if TYPE_CHECKING:
    import pandas


class NotRecorded(RecordingError, KeyError):
    """A topic or a field that a recording does not have; says which there are."""

    def __str__(self) -> str:
        return str(self.args[0])  # a KeyError would put it in quotes


class Table(Mapping[str, np.ndarray]):
    """The messages of one topic, by field.

    `table["p_WF"]` is (n, 4, 3) for n messages: the shape that `bus/messages.py` declares, behind the axis of
    time. Text is an array of strings. A field of open length is (n, ...) where all messages have the same shape,
    and an array of n arrays elsewhere.

    Attributes:
        key: of the topic.
        message: type of its messages.
        missing: how many messages their writer has numbered that are not there.
    """

    def __init__(self, key: str, message: type[Message], columns: dict[str, np.ndarray]):
        self.key, self.message = key, message
        self._columns = columns
        self.missing = _gaps(columns["boot"], columns["seq"])

    def __getitem__(self, field: str) -> np.ndarray:
        try:
            return self._columns[field]
        except KeyError:
            raise NotRecorded(f"{self.key}: no field {field!r} here; there are {', '.join(self)}") from None

    def __iter__(self) -> Iterator[str]:
        return iter(self._columns)

    def __len__(self) -> int:
        return len(self._columns)

    def __repr__(self) -> str:
        return f"<{self.key}: {self.rows} messages of {', '.join(self)}>"

    @property
    def rows(self) -> int:
        """How many messages."""
        return len(self.t)

    @property
    def t(self) -> np.ndarray:
        """(n,) times for which they are valid, on the run's clock [s]."""
        return self._columns["t"]

    def spec(self, field: str) -> FieldSpec:
        """Shape, unit and meaning of a field."""
        self[field]
        return specs(self.message)[field]

    def at(self, t: np.ndarray) -> np.ndarray:
        """(m,) row of the newest message at each of the times (m,) [s]; 0 before the first."""
        return np.maximum(np.searchsorted(self.t, t, side="right") - 1, 0)

    def flat(self) -> dict[str, np.ndarray]:
        """(n,) for each number of a message, by a name that says leg, joint or axis; see `column_names`."""
        found: dict[str, np.ndarray] = {}
        for field, values in self._columns.items():
            names = column_names(field, self.spec(field))
            if len(names) == 1:
                found[names[0]] = values
            else:
                found |= zip(names, values.reshape(len(values), -1).T, strict=True)
        return found

    def pandas(self) -> pandas.DataFrame:
        """The same as a data frame with time as its index.

        Raises:
            ConfigError: pandas is not installed.
        """
        try:
            import pandas
        except ImportError:
            raise ConfigError("data frames need pandas: pip install 'surefoot[data]'") from None
        found = self.flat()
        index = pandas.Index(found.pop("t"), name="t")
        rows = {name: list(values) if values.ndim > 1 else values for name, values in found.items()}
        return pandas.DataFrame(rows, index)


def _gaps(boot: np.ndarray, seq: np.ndarray) -> int:
    """Numbers that were skipped, of each start of the writer."""
    return sum(int(np.maximum(np.diff(seq[boot == each]) - 1, 0).sum()) for each in np.unique(boot))
