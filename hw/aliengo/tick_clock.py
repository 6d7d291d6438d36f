"""The robot's tick as time on a clock of ours."""

from __future__ import annotations

from math import inf

UNITS_S = {"us": 1e-6, "ms": 1e-3}
"""What a tick may be [s]; the vendor's files say both."""

_WINDOW_S = 1.0
"""How long ticks are watched, at the least, before their unit is told."""

_DRIFT = 0.01
"""How far the two clocks may run apart, as a share of time; quartz is a hundred times better."""

_WRAP = 1 << 32


class TickClock:
    """Orders ticks and tells when each was.

    A state arrives later than it was measured, by a delay that is never negative and often near its least. The
    least is not known; time here is such that the quickest state so far took none. That bound is forgotten slowly
    enough to follow a clock that runs differently.

    Attributes:
        unit: "us", "ms", "none" where arrival tells the time, "" while the unit is being found out.
    """

    def __init__(self, unit: str, drift: float = _DRIFT):
        """For one robot.

        Args:
            unit: one of `hw.aliengo.tick_unit`.
            drift: how far its clock and this one may run apart, as a share of time.
        """
        self.unit = "" if unit == "auto" else unit
        self._drift = drift
        self._newest: int | None = None
        self._ticks = 0  # since the first, without wraps
        self._began = self._arrived = 0.0
        self._offset = inf

    def ahead(self, tick: int) -> int:
        """How many ticks after the newest: 0 for a repeat, negative for an old one, 1 for the very first.

        Ticks have 32 bits; the nearer way round counts.
        """
        if self._newest is None:
            return 1
        return (tick - self._newest + _WRAP // 2) % _WRAP - _WRAP // 2

    def follow(self, tick: int, arrived: float) -> float:
        """Take the newest tick.

        Args:
            tick: ahead of all before.
            arrived: when it came [s].

        Returns:
            When it was, on the clock of `arrived` [s]: not after `arrived`, and never before an earlier tick.
        """
        if self._newest is None:
            self._began = self._arrived = arrived
        else:
            self._ticks += self.ahead(tick)
        self._newest = tick
        if not self.unit:
            self._find_unit(arrived - self._began)
        since, self._arrived = arrived - self._arrived, arrived
        if self.unit not in UNITS_S:
            return arrived
        robot_s = self._ticks * UNITS_S[self.unit]
        self._offset = min(self._offset + self._drift * since, arrived - robot_s)
        return robot_s + self._offset

    def _find_unit(self, elapsed: float) -> None:
        if elapsed >= _WINDOW_S:
            for unit, unit_s in UNITS_S.items():
                if abs(self._ticks * unit_s / elapsed - 1.0) < _DRIFT:
                    self.unit = unit
