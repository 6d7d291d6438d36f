"""How a message is declared: a frozen dataclass whose every field says its shape, unit and meaning.

Fields are made with `number`, `flag`, `text`, `names` and `array`; the codec reads their metadata. Values a
publisher leaves out are zero, false or empty; `valid` is false until the publisher vouches for the content.
"""

from __future__ import annotations

import dataclasses
from dataclasses import dataclass
from typing import Any, Self

import numpy as np


@dataclass(frozen=True)
class FieldSpec:
    """What the codec must know of a field.

    Attributes:
        kind: "number", "integer", "flag", "text", "names" (a list of strings) or "array".
        shape: of an array; -1 is any length.
        dtype: of an array.
        unit: SI unless the field's name has a suffix.
        doc: meaning and frame.
        finite: NaN and infinity are refused.
        volatile: a measurement of the machine, not of the robot (step times): equal runs may differ in it.
    """

    kind: str
    shape: tuple[int, ...] = ()
    dtype: str = "float64"
    unit: str = ""
    doc: str = ""
    finite: bool = True
    volatile: bool = False


def number(doc: str, unit: str = "", default: float = 0.0, finite: bool = True, volatile: bool = False) -> Any:
    """A float field."""
    spec = FieldSpec("number", unit=unit, doc=doc, finite=finite, volatile=volatile)
    return dataclasses.field(default=default, metadata={"spec": spec})


def integer(doc: str, default: int = 0) -> Any:
    """An integer field."""
    return dataclasses.field(default=default, metadata={"spec": FieldSpec("integer", doc=doc)})


def flag(doc: str, default: bool = False) -> Any:
    """A boolean field."""
    return dataclasses.field(default=default, metadata={"spec": FieldSpec("flag", doc=doc)})


def text(doc: str, default: str = "") -> Any:
    """A string field."""
    return dataclasses.field(default=default, metadata={"spec": FieldSpec("text", doc=doc)})


def names(doc: str) -> Any:
    """A list of strings, carried as a tuple."""
    return dataclasses.field(default=(), metadata={"spec": FieldSpec("names", doc=doc)})


def array(
    *shape: int, doc: str, unit: str = "", dtype: str = "float64", finite: bool = True, volatile: bool = False
) -> Any:
    """A numpy field of the given shape; an axis of -1 has any length and is empty by default."""
    spec = FieldSpec("array", shape, dtype, unit, doc, finite, volatile)
    blank = np.zeros([max(n, 0) for n in shape], dtype)
    blank.flags.writeable = False
    return dataclasses.field(default_factory=lambda: blank, metadata={"spec": spec})


@dataclass(frozen=True, eq=False, kw_only=True)
class Message:
    """What every message carries; the outbox fills `seq` and `boot`."""

    t: float = number("time the content is valid for, on the run's clock", "s")
    seq: int = integer("counts the publisher's messages on this topic, from 0, never wraps")
    boot: int = integer("changes when the publisher restarts; consumers drop what they cached")
    valid: bool = flag("the publisher vouches for the content")

    def numbered(self, seq: int, boot: int) -> Self:
        """The same message under a number: as `dataclasses.replace`, at a tenth of what that costs."""
        message = object.__new__(type(self))
        vars(message).update(vars(self), seq=seq, boot=boot)
        return message


def specs(cls: type[Message]) -> dict[str, FieldSpec]:
    """The fields of a message class in order, with their specifications."""
    return {field.name: field.metadata["spec"] for field in dataclasses.fields(cls)}
