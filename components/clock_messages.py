"""What the master of simulated time and the other processes say to each other, outside the topic table."""

from __future__ import annotations

import reprlib
from dataclasses import dataclass
from functools import lru_cache
from typing import Any

import msgpack
import numpy as np

from surefoot.bus.errors import MessageError
from surefoot.bus.service_keys import DONE as DONE
from surefoot.bus.service_keys import HELLO as HELLO
from surefoot.bus.service_keys import KEPT as KEPT
from surefoot.bus.service_keys import RELEASE as RELEASE
from surefoot.bus.service_keys import REQUEST as REQUEST

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
class Release:
    """A step is due.

    Attributes:
        t_ns: its time [ns]; `STOP_NS`: end.
        visible: how many messages of every topic are visible.
        resume: after a HELLO, where the process takes up.
        writers: marks of the sessions that are, or have been, each process; None where nothing has changed.
    """

    t_ns: int
    visible: dict[str, int]
    resume: Resume | None = None
    writers: dict[str, list[bytes]] | None = None


@dataclass(frozen=True)
class Hello:
    """A process is there.

    Attributes:
        boot: counts its restarts.
        new: it has no memory of this run; otherwise it waits for a release.
    """

    boot: int
    new: bool = True


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


def pack_release(release: Release) -> bytes:
    """Bytes of a release."""
    resume = release.resume and [release.resume.had, release.resume.snapshot]
    return msgpack.packb([release.t_ns, release.visible, resume, release.writers])


def unpack_release(payload: bytes) -> Release:
    """What `pack_release` packed.

    Raises:
        MessageError: it is no release.
    """
    t_ns, visible, resume, writers = _parts(payload, 4, RELEASE)
    _require(type(t_ns) is int, RELEASE, "time", t_ns)
    _require(_are_counts(visible), RELEASE, "counts", visible)
    if writers is not None:
        _require(_are_lists_of_bytes(writers), RELEASE, "writers", writers)
    if resume is None:
        return Release(t_ns, visible, None, writers)
    _require(isinstance(resume, list) and len(resume) == 2, RELEASE, "resume", resume)
    had, snapshot = resume
    _require(_are_counts(had), RELEASE, "counts", had)
    _require(isinstance(snapshot, bytes), RELEASE, "snapshot", snapshot)
    return Release(t_ns, visible, Resume(had, snapshot), writers)


def pack_hello(hello: Hello) -> bytes:
    """Bytes of a greeting."""
    return msgpack.packb([hello.boot, hello.new])


def unpack_hello(payload: bytes) -> Hello:
    """What `pack_hello` packed.

    Raises:
        MessageError: it is no greeting.
    """
    boot, new = _parts(payload, 2, HELLO)
    _require(type(boot) is int and boot >= 0, HELLO, "boot", boot)
    _require(type(new) is bool, HELLO, "new", new)
    return Hello(boot, new)


def pack_done(done: Done) -> bytes:
    """Bytes of a done token."""
    return msgpack.packb([done.t_ns, done.sent, done.snapshot])


def unpack_done(payload: bytes) -> Done:
    """What `pack_done` packed.

    Raises:
        MessageError: it is no done token.
    """
    t_ns, sent, snapshot = _parts(payload, 3, DONE)
    _require(type(t_ns) is int, DONE, "time", t_ns)
    _require(_are_lists_of_bytes(sent), DONE, "messages", sent)
    _require(isinstance(snapshot, bytes), DONE, "snapshot", snapshot)
    return Done(t_ns, sent, snapshot)


def pack_snapshot(state: dict[str, Any]) -> bytes:
    """Bytes of a snapshot: numbers, strings, bytes, lists and arrays by name."""
    return msgpack.packb(state, default=_pack_array)


def unpack_snapshot(payload: bytes) -> dict[str, Any]:
    """What `pack_snapshot` packed; arrays may be written to."""
    return msgpack.unpackb(payload, ext_hook=_unpack_array)


def _parts(payload: bytes, count: int, what: str) -> list[Any]:
    parts = _unpack(payload, what)
    _require(isinstance(parts, list) and len(parts) == count, what, "whole", parts)
    return parts


def _unpack(payload: bytes, what: str) -> Any:
    try:
        return msgpack.unpackb(payload)
    except Exception as error:
        raise MessageError(f"{what}: not msgpack ({error!s:.80}); {len(payload)} bytes dropped") from None


def _are_counts(value: Any) -> bool:
    return isinstance(value, dict) and all(
        isinstance(key, str) and type(count) is int and count >= 0 for key, count in value.items()
    )


def _are_lists_of_bytes(value: Any) -> bool:
    return isinstance(value, dict) and all(
        isinstance(name, str) and isinstance(items, list) and all(isinstance(item, bytes) for item in items)
        for name, items in value.items()
    )


def _require(holds: bool, key: str, what: str, found: Any) -> None:
    if not holds:
        raise MessageError(f"{key}: {what} {reprlib.repr(found):.80} is not what the clock's messages hold")


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
