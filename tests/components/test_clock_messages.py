"""What the clock's master and the processes say to each other is what was said, or refused by name."""

import msgpack
import numpy as np
import pytest

from surefoot.bus.errors import MessageError
from surefoot.components import clock_messages as clock

RESUME = clock.Resume({"hw/state": 3}, b"memory")
RELEASES = (
    clock.Release(2_000_000, {"hw/state": 2}),
    clock.Release(0, {}, RESUME, {"io": [b"mark", b""], "wbc": []}),
    clock.Release(clock.STOP_NS, {}, clock.Resume({}, b"")),
)
DONE = clock.Done(4_000_000, {"joint/command": [b"one", b""], "fsm/event": []}, b"\x80")


def test_they_come_through_as_they_were():
    for release in RELEASES:
        assert clock.unpack_release(clock.pack_release(release)) == release
    assert clock.unpack_done(clock.pack_done(DONE)) == DONE
    assert clock.unpack_hello(clock.pack_hello(clock.Hello(3, new=False))) == clock.Hello(3, new=False)


@pytest.mark.parametrize(
    ("unpack", "key", "true"),
    [
        *((clock.unpack_release, clock.RELEASE, clock.pack_release(release)) for release in RELEASES),
        (clock.unpack_done, clock.DONE, clock.pack_done(DONE)),
        (clock.unpack_hello, clock.HELLO, clock.pack_hello(clock.Hello(1))),
    ],
)
def test_anything_else_is_refused_by_key_or_is_well_formed(unpack, key, true):
    rng = np.random.default_rng(5)
    wrong = [rng.bytes(int(rng.integers(0, 40))) for _ in range(500)]
    for _ in range(2000):
        data = bytearray(true)
        data[int(rng.integers(len(data)))] = int(rng.integers(256))
        wrong += [bytes(data), true[: int(rng.integers(len(true)))], true + rng.bytes(2)]
    parts = msgpack.unpackb(true)
    for value in (
        None,
        -2,
        1.5,
        True,
        "a",
        b"a",
        [],
        {},
        {"a": -1},
        {1: 1},
        {"a": [1]},
        [{}, ""],
        [{"a": 1.0}, b""],
    ):
        wrong.append(msgpack.packb(value))
        for index in range(len(parts) if isinstance(parts, list) else 0):
            wrong.append(msgpack.packb([*parts[:index], value, *parts[index + 1 :]]))
    refused = 0
    for data in wrong:
        try:
            found = unpack(data)
        except MessageError as error:
            assert str(error).startswith(f"{key}: ") and len(str(error)) < 300
            refused += 1
            continue
        well_formed(found)
    assert refused > 500


def well_formed(found):
    """A mutation may be a message of its own: then its types are those that are promised."""
    if isinstance(found, clock.Release):
        assert type(found.t_ns) is int and all(type(count) is int for count in found.visible.values())
        if found.resume is not None:
            assert isinstance(found.resume.snapshot, bytes)
            assert all(type(count) is int for count in found.resume.had.values())
        for marks in (found.writers or {}).values():
            assert all(isinstance(mark, bytes) for mark in marks)
    elif isinstance(found, clock.Done):
        assert type(found.t_ns) is int and isinstance(found.snapshot, bytes)
        assert all(isinstance(payload, bytes) for payloads in found.sent.values() for payload in payloads)
    else:
        assert type(found.boot) is int and found.boot >= 0 and type(found.new) is bool
