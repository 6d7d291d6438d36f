"""What a recorder is, and the one way its rows become a CSV file."""

from __future__ import annotations

import csv
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Protocol

import numpy as np

from surefoot.bus.message import Message


@dataclass(frozen=True)
class Column:
    """One column of a CSV file; its name ends in its unit.

    Attributes:
        name: such as `asked_x_n`.
        doc: what it holds, with frame and unit.
    """

    name: str
    doc: str


class Recorder(Protocol):
    """Listens to a run (`Lockstep.listen`)."""

    @property
    def columns(self) -> Sequence[Column]:
        """Of its CSV file."""

    def __call__(self, key: str, message: Message) -> None:
        """Take in one message."""

    def arrays(self) -> dict[str, np.ndarray]:
        """What is kept, for `numpy.savez`."""

    def rows(self) -> list[list[float | str]]:
        """The rows of the CSV file."""


def write_csv(path: Path, columns: Sequence[Column], rows: Sequence[Sequence[object]]) -> None:
    """A header of column names, then the rows; figures to six significant digits."""
    with path.open("w", newline="") as file:
        writer = csv.writer(file)
        writer.writerow([column.name for column in columns])
        writer.writerows([f"{value:.6g}" if isinstance(value, float) else value for value in row] for row in rows)


def read_csv(path: Path) -> tuple[list[str], list[list[str]]]:
    """Names of the columns, and the rows as text."""
    with path.open(newline="") as file:
        head, *rows = csv.reader(file)
    return head, rows
