"""Plays a recording back on a bus of its own, at its pace, for viewers."""

from __future__ import annotations

import heapq
import time
from collections.abc import Callable, Iterator
from itertools import count
from pathlib import Path

from surefoot.bus.errors import RecordingError
from surefoot.bus.recording.reader import Recorded, Recording
from surefoot.bus.session import Session
from surefoot.bus.topics import TOPICS
from surefoot.components.deployment_desk import serve_tables

_AHEAD_S = 2.0  # journals of different processes lie this far apart in the file at the most
_SAY_S = 5.0


def playback(
    path: Path, namespace: str, speed: float, from_t: float, until_t: float, say: Callable[[str], None]
) -> int:
    """Publish a recording's messages under their topics; returns how many.

    Args:
        path: of the recording.
        namespace: of the bus, which this process opens.
        speed: seconds of the run for each second on the wall.
        from_t, until_t: what is played, in the run's time [s].
        say: is told how it goes.

    Raises:
        BusError: another stack runs under this namespace.
        RecordingError: it is no recording, or holds nothing of that time.
    """
    recording = Recording(path)
    session = Session(namespace, hub=True)
    serve_tables(session, recording.config)
    say(f"playing {path} on namespace {namespace!r} at {speed:g} x; Ctrl-C ends it")
    begun = told = time.monotonic()
    first, sent = None, 0
    try:
        for item in _in_time_order(recording):
            t = item.t_ns / 1e9
            if not from_t <= t <= until_t:
                continue
            first = t if first is None else first
            wait = begun + (t - first) / speed - time.monotonic()
            if wait > 0.0:
                time.sleep(wait)
            session.put(item.key, item.payload, lossless=False)
            sent += 1
            if time.monotonic() - told > _SAY_S:
                told = time.monotonic()
                say(f"{t:.1f} s")
    finally:
        session.close()
    if not sent:
        raise RecordingError(f"{path}: nothing recorded between {from_t:g} and {until_t:g} s")
    say(f"played {sent} messages")
    return sent


def _in_time_order(recording: Recording) -> Iterator[Recorded]:
    """Messages on topics by time, those of equal time in the order of the file."""
    waiting: list[tuple[int, int, Recorded]] = []
    numbers, newest = count(), 0
    for item in recording:
        if item.key not in TOPICS or item.digest:
            continue
        newest = max(newest, item.t_ns)
        heapq.heappush(waiting, (item.t_ns, next(numbers), item))
        while waiting and waiting[0][0] < newest - _AHEAD_S * 1e9:
            yield heapq.heappop(waiting)[2]
    while waiting:
        yield heapq.heappop(waiting)[2]
