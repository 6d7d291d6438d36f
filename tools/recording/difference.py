"""Where two messages differ, in words."""

from __future__ import annotations

import math
from hashlib import blake2b
from typing import Any

import numpy as np

from surefoot.bus.codec import encode
from surefoot.bus.message import Message, specs

_SHOWN = 80


def canonical(message: Message) -> bytes:
    """The bytes that equal runs have in common: without measurements of the machine."""
    return encode(message, volatile=False)


def digest(message: Message) -> bytes:
    """Eight bytes that differ when `canonical` does."""
    return blake2b(canonical(message), digest_size=8).digest()


def first_difference(recorded: Message, replayed: Message, tolerance: float = 0.0) -> str:
    """The first field in which two messages of a type differ, with both values; empty if there is none.

    Args:
        recorded, replayed: the messages.
        tolerance: numbers may differ by this much of the largest in their field, or of one.
    """
    for name, spec in specs(type(recorded)).items():
        if spec.volatile:
            continue
        old, new = getattr(recorded, name), getattr(replayed, name)
        if spec.kind == "array":
            if (words := _array_difference(np.asarray(old), np.asarray(new), tolerance)) != "":
                return f"{name}{words}"
        elif spec.kind == "number":
            if abs(old - new) > tolerance * max(abs(old), 1.0) or math.isnan(old) != math.isnan(new):
                return f"{name}: recorded {old!r}, now {new!r}"
        elif old != new and not (tolerance and spec.kind == "text"):  # figures in words are rounded
            return f"{name}: recorded {_short(old)}, now {_short(new)}"
    return ""


def _array_difference(old: np.ndarray, new: np.ndarray, tolerance: float) -> str:
    if old.shape != new.shape:
        return f": recorded shape {old.shape}, now {new.shape}"
    equal = old == new
    if old.dtype.kind == "f":
        equal &= (np.signbit(old) == np.signbit(new)) | (tolerance > 0.0)  # the bytes of -0 and 0 differ
        equal |= np.isnan(old) & np.isnan(new)
        largest = np.nanmax(np.abs(old), initial=1.0)
        equal |= np.abs(new - old) <= tolerance * largest if tolerance else False
    if equal.all():
        return ""
    where = tuple(int(index[0]) for index in np.nonzero(~equal))
    count = int(np.count_nonzero(~equal))
    place = f"[{', '.join(map(str, where))}]" if where else ""
    more = f" ({count} of {equal.size} entries differ)" if equal.size > 1 else ""
    return f"{place}: recorded {old[where]!s}, now {new[where]!s}{more}"


def _short(value: Any) -> str:
    text = repr(value)
    return text if len(text) <= _SHOWN else f"{text[: _SHOWN - 3]}..."
