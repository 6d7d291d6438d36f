"""What the master of simulated time and the other processes say to each other, outside the topic table."""

from __future__ import annotations

from dataclasses import dataclass
from functools import lru_cache
from typing import Any

import msgpack
import numpy as np

from surefoot.bus.service_keys import DONE as DONE
from surefoot.bus.service_keys import HELLO as HELLO
from surefoot.bus.service_keys import KEPT as KEPT
from surefoot.bus.service_keys import RELEASE as RELEASE
from surefoot.bus.service_keys import REQUEST as REQUEST

NEW, STILL_THERE = b"", b"still there"
"""What a HELLO says: a process without memory of this run, or one that waits for a release."""

STOP_NS = -1
"""Release time that means: end."""


@dataclass(frozen=True)
class Resume:
    """Where a process that was not there takes up.

    Attributes:
        had: how many messages of each topic its predecessor had read at its last finished step.
        snapshot: of its predecessor after that step; empty if there was none, or it was not active yet.
    """

    had: dict[str, int]
    snapshot: bytes


@dataclass(frozen=True)
class Done:
    """A step is over.

    Attributes:
        t_ns: the release it answers [ns].
        sent: the messages it published on each topic, in bytes.
        snapshot: the component's memory after it, packed; empty if it is not active yet.
    """

    t_ns: int
    sent: dict[str, list[bytes]]
    snapshot: bytes


def pack_release(t_ns: int, visible: dict[str, int], resume: Resume | None = None) -> bytes:
    """A release at `t_ns` with how many messages of every topic are visible; `resume` after a HELLO."""
    return msgpack.packb([t_ns, visible, resume and [resume.had, resume.snapshot]])


def unpack_release(payload: bytes) -> tuple[int, dict[str, int], Resume | None]:
    """What `pack_release` packed."""
    t_ns, visible, resume = msgpack.unpackb(payload)
    return t_ns, visible, resume and Resume(*resume)


def pack_done(done: Done) -> bytes:
    """Bytes of a done token."""
    return msgpack.packb([done.t_ns, done.sent, done.snapshot])


def unpack_done(payload: bytes) -> Done:
    """What `pack_done` packed."""
    return Done(*msgpack.unpackb(payload))


def pack_snapshot(state: dict[str, Any]) -> bytes:
    """Bytes of a snapshot: numbers, strings, bytes, lists and arrays by name."""
    return msgpack.packb(state, default=_pack_array)


def unpack_snapshot(payload: bytes) -> dict[str, Any]:
    """What `pack_snapshot` packed; arrays may be written to."""
    return msgpack.unpackb(payload, ext_hook=_unpack_array)


def _pack_array(value: Any) -> Any:
    if isinstance(value, np.ndarray):
        return msgpack.ExtType(0, _head(value.dtype, value.shape) + value.tobytes())
    if isinstance(value, np.generic):
        return value.item()
    raise TypeError(f"a snapshot holds numbers, strings, bytes, lists and arrays, not {type(value).__name__}")


@lru_cache(maxsize=1024)
def _head(dtype: np.dtype, shape: tuple[int, ...]) -> bytes:
    """What precedes an array's bytes: the same few come step after step."""
    return msgpack.packb([dtype.str, shape])


def _unpack_array(code: int, payload: bytes) -> np.ndarray:
    unpacker = msgpack.Unpacker()
    unpacker.feed(payload)
    dtype, shape = unpacker.unpack()
    return np.frombuffer(payload, dtype, offset=unpacker.tell()).reshape(shape).copy()
