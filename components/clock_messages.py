"""What the master of simulated time and the other processes say to each other, outside the topic table."""

from __future__ import annotations

import msgpack

RELEASE, DONE, HELLO = "clock/release", "clock/done", "clock/hello"
"""Key prefixes; the process's name follows. HELLO: the process is ready, or ready again after a restart."""

REQUEST = "operator/request"
"""Key on which people's commands reach the clock's master, which dates and numbers them."""

STOP_NS = -1
"""Release time that means: deactivate and end."""


def pack_release(t_ns: int, visible: dict[str, int], before: dict[str, int]) -> bytes:
    """A release at t_ns.

    Args:
        t_ns: its time.
        visible: how many messages of every topic are visible.
        before: how many were visible when the process said hello; it may have missed those.
    """
    return msgpack.packb([t_ns, visible, before])


def unpack_release(payload: bytes) -> tuple[int, dict[str, int], dict[str, int]]:
    t_ns, visible, before = msgpack.unpackb(payload)
    return t_ns, visible, before


def pack_done(t_ns: int, counts: dict[str, int], step_ms: float) -> bytes:
    """The step of the release at t_ns is over, with how many messages on each topic."""
    return msgpack.packb([t_ns, counts, step_ms])


def unpack_done(payload: bytes) -> tuple[int, dict[str, int], float]:
    t_ns, counts, step_ms = msgpack.unpackb(payload)
    return t_ns, counts, step_ms
