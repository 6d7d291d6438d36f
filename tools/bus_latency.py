"""How long a message takes from one process to another, and what it costs them; on real messages and sessions."""

from __future__ import annotations

import heapq
import multiprocessing
import queue
import struct
import time
from collections.abc import Callable, Mapping
from dataclasses import dataclass
from multiprocessing.synchronize import Barrier, Event
from typing import Any

import numpy as np

from surefoot.bus.codec import decode, encode
from surefoot.bus.errors import BusError
from surefoot.bus.session import Session
from surefoot.bus.topics import TOPICS

EVENT_HZ = 10.0
"""Topics that are published on events have no rate of their own; they are sent so often here."""

_ENVELOPE = struct.Struct("<di")
"""Goes before each payload: when it was put, on the monotonic clock all processes share [s], and its number."""

_WARM_UP = -1  # number of the messages that are sent until every topic has been heard once
_PHASE_S = 2e-4  # between the first messages of two topics
_LOOK_S = 0.01
_DRAIN_S = 0.5
_PATIENCE_S = 120.0


@dataclass(frozen=True)
class _Link:
    """What the three processes share."""

    namespace: str
    hub_up: Event
    heard: Event
    together: Barrier
    results: multiprocessing.Queue[tuple[str, float, Any]]


def bus_latency(namespace: str, messages: Mapping[str, list[bytes]], seconds: float) -> dict[str, Any]:
    """Send every topic at its rate, with the congestion control of the monotonic clock, and see what arrives.

    Three processes as in a run: the hub publishes the topics of `io`, straight to its clients; a client
    publishes the others, through the hub; another client reads all.

    Args:
        namespace: of a bus of its own.
        messages: encoded messages of each topic, sent in turn.
        seconds: of sending.

    Returns:
        `topics`: for each its `bytes` (mean), `hz`, whether `direct` from the hub, `p50_ms` and `p99_ms` from
        before the publisher's call to the reader's, `sent`, `lost`, and the CPU time `encode_us` and `decode_us`;
        `cpu_us` for each message: of the publishing `client`, which is woken for it, of the `hub` (published
        and routed) and of the `reader`, without encoding and decoding.

    Raises:
        BusError: the processes did not come up, or one ended.
    """
    context = multiprocessing.get_context("spawn")
    link = _Link(namespace, context.Event(), context.Event(), context.Barrier(3), context.Queue())
    own = {key: each for key, each in messages.items() if TOPICS[key].writer == "io"}
    others = {key: each for key, each in messages.items() if key not in own}
    children = [
        context.Process(target=_publish, args=("hub", link, own, seconds), daemon=True),
        context.Process(target=_publish, args=("client", link, others, seconds), daemon=True),
        context.Process(target=_read, args=(link, list(messages)), daemon=True),
    ]
    for child in children:
        child.start()
    try:
        results = {name: (cpu_s, found) for name, cpu_s, found in (_result(link, children) for _ in children)}
        for child in children:
            child.join(_PATIENCE_S)
    finally:
        for child in children:
            child.kill()
            child.join()
    sent: dict[str, int] = results["hub"][1] | results["client"][1]
    arrived: dict[str, np.ndarray] = results["reader"][1]
    count = {"client": _total(results["client"][1]), "hub": _total(sent)}
    count["reader"] = sum(len(latency_s) for latency_s in arrived.values())
    return {
        "topics": {key: _topic(key, messages[key], sent[key], arrived[key]) for key in messages},
        "cpu_us": {name: 1e6 * cpu_s / max(count[name], 1) for name, (cpu_s, _) in results.items()},
    }


def _result(link: _Link, children: list) -> tuple[str, float, Any]:
    """What one of the processes has found."""
    end = time.monotonic() + _PATIENCE_S
    while True:
        try:
            return link.results.get(timeout=1.0)
        except queue.Empty:
            if any(child.exitcode for child in children) or time.monotonic() > end:
                raise BusError("bench: a process that measures the bus has ended, or does not come up") from None


def _total(counts: Mapping[str, int]) -> int:
    return sum(counts.values())


def _topic(key: str, payloads: list[bytes], sent: int, latency_s: np.ndarray) -> dict[str, Any]:
    latency_ms = 1e3 * latency_s if latency_s.size else np.full(1, np.inf)
    kind = TOPICS[key].message
    begun = time.process_time()
    decoded = [decode(kind, payload) for payload in payloads]
    between = time.process_time()
    for message in decoded:
        encode(message)
    ended = time.process_time()
    return {
        "bytes": float(np.mean([len(payload) for payload in payloads])),
        "hz": _rate_hz(key),
        "direct": TOPICS[key].writer == "io",
        "p50_ms": float(np.median(latency_ms)),
        "p99_ms": float(np.percentile(latency_ms, 99)),
        "sent": sent,
        "lost": sent - latency_s.size,
        "encode_us": 1e6 * (ended - between) / len(payloads),
        "decode_us": 1e6 * (between - begun) / len(payloads),
    }


def _rate_hz(key: str) -> float:
    return TOPICS[key].rate_hz or EVENT_HZ


def _publish(role: str, link: _Link, messages: Mapping[str, list[bytes]], seconds: float) -> None:
    """The process of a publisher."""
    if role != "hub":
        _await(link.hub_up)
    session = Session(link.namespace, hub=role == "hub")
    link.hub_up.set()
    _send(session, messages, link.heard.is_set, counted=False)
    link.together.wait(_PATIENCE_S)
    cpu_s, end = time.process_time(), time.monotonic() + seconds
    sent = _send(session, messages, lambda: time.monotonic() > end, counted=True)
    link.together.wait(_PATIENCE_S)
    link.results.put((role, time.process_time() - cpu_s, sent))
    link.together.wait(_PATIENCE_S)
    session.close()


def _send(
    session: Session, messages: Mapping[str, list[bytes]], over: Callable[[], bool], counted: bool
) -> dict[str, int]:
    """Send at the topics' rates until it is over; deadlines that were missed are skipped, as a process does."""
    sent = dict.fromkeys(messages, 0)
    begun = time.monotonic()
    due = [(begun + _PHASE_S * index, key) for index, key in enumerate(messages)]
    while not over():
        if not due:
            time.sleep(_LOOK_S)
            continue
        at, key = due[0]
        if (wait_s := at - time.monotonic()) > 0.0:
            time.sleep(wait_s)
        payload = messages[key][sent[key] % len(messages[key])]
        number = sent[key] if counted else _WARM_UP
        lossless = not TOPICS[key].rate_hz
        session.put(key, _ENVELOPE.pack(time.monotonic(), number) + payload, lossless)
        sent[key] += 1
        period_s = 1.0 / _rate_hz(key)
        missed = int((time.monotonic() - at) / period_s)
        heapq.heapreplace(due, (at + (missed + 1) * period_s, key))
    return sent


def _read(link: _Link, keys: list[str]) -> None:
    """The process of the reader."""
    _await(link.hub_up)
    session = Session(link.namespace)
    heard: set[str] = set()
    latency_s: dict[str, list[float]] = {key: [] for key in keys}

    def receive(key: str, payload: bytes) -> None:
        now = time.monotonic()
        sent, number = _ENVELOPE.unpack_from(payload)
        heard.add(key)
        if number != _WARM_UP:
            latency_s[key].append(now - sent)

    for key in keys:
        session.subscribe(key, receive)
    end = time.monotonic() + _PATIENCE_S
    while len(heard) < len(keys):
        if time.monotonic() > end:
            raise BusError(f"bench: not heard: {', '.join(key for key in keys if key not in heard)}")
        time.sleep(_LOOK_S)
    link.heard.set()
    link.together.wait(_PATIENCE_S)
    cpu_s = time.process_time()
    link.together.wait(_PATIENCE_S)
    time.sleep(_DRAIN_S)
    cpu_s = time.process_time() - cpu_s
    link.results.put(("reader", cpu_s, {key: np.array(each) for key, each in latency_s.items()}))
    link.together.wait(_PATIENCE_S)
    session.close()


def _await(event: Event) -> None:
    if not event.wait(_PATIENCE_S):
        raise BusError("bench: the hub did not come up")
