"""Figures into the number types of a packet: they end at the type's limit, and never wrap."""

from __future__ import annotations

from collections.abc import Sequence
from functools import cache

import numpy as np


def store(
    out: np.ndarray, what: str, names: Sequence[str], values: np.ndarray, scale: float = 1.0
) -> tuple[str, ...]:
    """Write figures into a field of a packet.

    Integers are cut off towards zero from a product in single precision, as the vendor's SDK does it, but where
    that wraps (a torque of 200 N m becomes -56) the largest or smallest figure is stored that the type has.

    Args:
        out: (n,) the field.
        what: its name, for words.
        names: of the n values, for words.
        values: (n,) finite.
        scale: units of the field in one of ours.

    Returns:
        In words which figures were limited, and to what.
    """
    if out.dtype.kind == "f":
        out[:] = values
        return ()
    scaled = np.trunc(values.astype(np.float32) * np.float32(scale))
    stored = np.clip(scaled, *_limits(out.dtype))
    out[:] = stored
    if (stored == scaled).all():
        return ()
    return tuple(
        f"{what} of {names[n]} = {values[n]:.6g} does not fit the packet: {stored[n] / scale:.6g} is sent"
        for n in np.flatnonzero(stored != scaled).tolist()
    )


@cache
def _limits(dtype: np.dtype) -> tuple[np.float32, np.float32]:
    """The smallest and the largest figure of an integer type."""
    limits = np.iinfo(dtype)
    return np.float32(limits.min), np.float32(limits.max)
