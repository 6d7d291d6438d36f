"""When the next cycle is due."""

from __future__ import annotations

from math import floor


class Deadlines:
    """Absolute deadlines of a fixed rate; those that have passed are skipped, never made up in a burst."""

    def __init__(self, period: float, begin: float):
        """`period` in seconds; `begin`: the first deadline, on any clock [s]."""
        self._period, self._deadline = period, begin

    def following(self, now: float) -> tuple[float, int]:
        """The next deadline after `now`, and how many passed unused since the last one."""
        self._deadline += self._period
        missed = max(floor((now - self._deadline) / self._period) + 1, 0)
        self._deadline += missed * self._period
        return self._deadline, missed
