"""Whether the operator's side is there: it beats, and only the time without a beat counts."""

from __future__ import annotations

import time
from collections.abc import Callable


class Heartbeat:
    """Tells when the last beat is too long ago.

    It goes by this machine's monotonic clock, also where simulated time runs slower or faster: a beat says that a
    person's machine is there now, and how long that holds is a matter of the person's time. Where simulated time
    stands still nothing moves either, and the first instant after that sees what has been missing meanwhile.
    """

    def __init__(self, limit_s: float, clock: Callable[[], float] = time.monotonic):
        """`limit_s`: how long the robot may go without a beat [s]; 0: none is asked for."""
        self._limit_s, self._clock = limit_s, clock
        self._last: float | None = None
        self._told = True  # before the first beat there is nothing to lose

    def beat(self) -> None:
        """The operator's side is there (the bus's thread)."""
        self._last, self._told = self._clock(), False

    @property
    def missing(self) -> str:
        """In words that nobody is there; empty where somebody is, or where nobody has to be."""
        if not self._limit_s:
            return ""
        if self._last is None:
            return "no heartbeat yet"
        return f"no heartbeat for {self._limit_s:g} s" if self._clock() - self._last > self._limit_s else ""

    def lost(self) -> str:
        """The same, once for each time that it stops."""
        missing = self.missing
        if not missing or self._told:
            return ""
        self._told = True
        return missing
