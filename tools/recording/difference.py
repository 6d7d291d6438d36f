"""Where two messages differ, in words."""

from __future__ import annotations

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


def first_difference(recorded: Message, replayed: Message) -> str:
    """The first field in which two messages of a type differ, with both values; empty if there is none."""
    for name, spec in specs(type(recorded)).items():
        if spec.volatile:
            continue
        old, new = getattr(recorded, name), getattr(replayed, name)
        if spec.kind == "array":
            if (words := _array_difference(np.asarray(old), np.asarray(new))) != "":
                return f"{name}{words}"
        elif old != new:
            return f"{name}: recorded {_short(old)}, now {_short(new)}"
    return ""


def _array_difference(old: np.ndarray, new: np.ndarray) -> str:
    if old.shape != new.shape:
        return f": recorded shape {old.shape}, now {new.shape}"
    equal = old == new
    if old.dtype.kind == "f":
        equal |= np.isnan(old) & np.isnan(new)
        equal &= np.signbit(old) == np.signbit(new)  # the bytes of -0 and 0 differ
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
