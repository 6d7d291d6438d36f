"""What a link does to packets between sender and receiver."""

from __future__ import annotations

import heapq
from math import inf
from typing import NamedTuple

import numpy as np

from surefoot.config.emulator import Wire

_SAME_S = 1e-9
"""Times that are closer are one: a number of cycles and a latency do not add up to the last digit."""


class Packet(NamedTuple):
    """A packet and whose it is: who sent it, or who is to get it."""

    data: bytes
    peer: tuple[str, int]


class LinkFaults:
    """One direction of a link. It has no clock: the same packets at the same times arrive in the same way."""

    def __init__(self, settings: Wire, rng: np.random.Generator):
        self._settings = settings
        self._fate, self._bits = rng.spawn(2)
        self._held: list[tuple[float, int, Packet]] = []
        self._copies = 0

    @property
    def next_t(self) -> float:
        """When something arrives next [s]; infinite when nothing is on its way."""
        return self._held[0][0] if self._held else inf

    def send(self, packet: Packet, t: float) -> None:
        """Put a packet in at time `t` [s]."""
        settings = self._settings
        bad = settings.bad_from_s <= t < settings.bad_until_s
        # Always as many figures, so that one setting never shifts what another draws.
        lost, doubled, held_back, damaged, *jitter = self._fate.random(6)
        if bad and lost < settings.loss:
            return
        if bad and damaged < settings.corrupt:
            packet = packet._replace(data=self._damage(packet.data))
        arrives = t + settings.latency_s + settings.reorder_s * (bad and held_back < settings.reorder)
        for share in jitter[: 1 + (bad and doubled < settings.duplicate)]:
            heapq.heappush(self._held, (arrives + settings.jitter_s * share, self._copies, packet))
            self._copies += 1

    def due(self, t: float) -> list[Packet]:
        """What has arrived by time `t` [s] and was not taken before, in order of arrival."""
        arrived = []
        while self.next_t <= t + _SAME_S:
            arrived.append(heapq.heappop(self._held)[2])
        return arrived

    def _damage(self, data: bytes) -> bytes:
        bits = np.unpackbits(np.frombuffer(data, np.uint8))
        count = min(self._settings.corrupt_bits, len(bits))
        bits[self._bits.choice(len(bits), count, replace=False)] ^= 1
        return np.packbits(bits).tobytes()
