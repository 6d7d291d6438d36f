"""A recording as numbers: a CSV or Parquet file for each topic, and one that says what the columns mean."""

from __future__ import annotations

import csv
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np

from surefoot.bus.message import specs
from surefoot.bus.topics import TOPICS
from surefoot.config.typed_toml import ConfigError
from surefoot.tools.export.contents import Contents
from surefoot.tools.tables.column_names import column_names
from surefoot.tools.tables.recording_tables import RecordingTables
from surefoot.tools.tables.table import Table

COLUMNS = "columns.csv"
_CHUNK = 10_000  # rows that are text at once

Say = Callable[[str], None]


def write_csv(recording: RecordingTables, wanted: Contents, folder: Path, say: Say) -> list[Path]:
    """One `TOPIC.csv` a topic, as exact as it was recorded. Fields of open length are left out, and told.

    Raises:
        OSError: a file cannot be written.
    """
    return _write(recording, wanted, folder, _csv, say)


def write_parquet(recording: RecordingTables, wanted: Contents, folder: Path, say: Say) -> list[Path]:
    """One `TOPIC.parquet` a topic; fields of open length are lists. Units and meanings are with the columns.

    Raises:
        ConfigError: pyarrow is not installed.
        OSError: a file cannot be written.
    """
    try:
        import pyarrow  # noqa: F401
    except ImportError:
        raise ConfigError("Parquet needs pyarrow: pip install 'surefoot[data]'") from None
    return _write(recording, wanted, folder, _parquet, say)


def _write(
    recording: RecordingTables, wanted: Contents, folder: Path, write: Callable[[Table, Path], None], say: Say
) -> list[Path]:
    folder.mkdir(parents=True, exist_ok=True)
    files, meanings = [], []
    for key in wanted.keys:
        known = specs(TOPICS[key].message)
        left_out = [name for name, spec in known.items() if write is _csv and -1 in spec.shape]
        kept = [name for name in known if name not in left_out]
        table = recording.read(key, kept, wanted.begin_s, wanted.end_s)
        path = folder / f"{key.replace('/', '_')}.{'csv' if write is _csv else 'parquet'}"
        write(table, path)
        say(f"{path.name}: {table.rows} messages of {key}")
        if left_out:
            say(f"  without {', '.join(left_out)}, of open length: parquet and json-mcap have them")
        meanings += _meanings(table)
        files.append(path)
    with (folder / COLUMNS).open("w", newline="") as file:
        csv.writer(file).writerows([("topic", "column", "unit", "meaning"), *meanings])
    return [*files, folder / COLUMNS]


def _meanings(table: Table) -> list[tuple[str, str, str, str]]:
    """(topic, column, unit, meaning) of every column."""
    return [
        (table.key, name, table.spec(field).unit, table.spec(field).doc)
        for field in table
        for name in column_names(field, table.spec(field))
    ]


def _csv(table: Table, path: Path) -> None:
    found = table.flat()
    with path.open("w", newline="") as file:
        writer = csv.writer(file)
        writer.writerow(found)
        for begin in range(0, table.rows, _CHUNK):
            block = [_told(values[begin : begin + _CHUNK]) for values in found.values()]
            writer.writerows(zip(*block, strict=True))


def _told(values: np.ndarray) -> list[Any]:
    """As Python prints them: every digit that tells a number from the next."""
    return [" ".join(each) if isinstance(each, tuple) else each for each in values.tolist()]


def _parquet(table: Table, path: Path) -> None:
    import pyarrow
    from pyarrow import parquet

    arrays, fields = [], []
    units = {name: (unit, doc) for _, name, unit, doc in _meanings(table)}
    for name, values in table.flat().items():
        array = (
            pyarrow.array(values) if values.ndim == 1 and values.dtype != object else pyarrow.array(_lists(values))
        )
        unit, meaning = units[name]
        arrays.append(array)
        fields.append(pyarrow.field(name, array.type, metadata={"unit": unit, "meaning": meaning}))
    parquet.write_table(pyarrow.table(arrays, pyarrow.schema(fields, metadata={"topic": table.key})), path)


def _lists(values: np.ndarray) -> list[Any]:
    return [each.tolist() if isinstance(each, np.ndarray) else each for each in values]
