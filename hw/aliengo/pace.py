"""When commands leave for a robot that is to hear one in every cycle."""

from __future__ import annotations

from math import floor, inf


class Pace:
    """A new order leaves at once, but for a gap to the command before it; without one the last goes again.

    It goes again when a whole cycle has passed without an order, and from then on in every cycle. So a caller that
    orders once in a cycle, sooner or later in it, or leaves some out, makes the robot hear no more commands than
    there are cycles. Nothing that is late is made up.

    Attributes:
        due: when a command leaves at the latest, on any clock [s].
    """

    def __init__(self, period: float, gap: float, begin: float):
        """`period` of a cycle, `gap` between two commands at the least [s]; `begin`: the first is due [s]."""
        self._period, self._gap = period, gap
        self._free = -inf
        self._waits = False
        self.due = begin

    def order(self, now: float) -> bool:
        """A new order has come: whether it leaves now; if not, it is due when the gap is over."""
        self._waits = True
        if now >= self._free:
            return True
        self.due = min(self.due, self._free)
        return False

    def left(self, now: float) -> int:
        """A command has left; how many cycles have passed without the one that was due."""
        missed = max(floor((now - self.due) / self._period), 0)
        self.due = now + 2.0 * self._period if self._waits else self.due + (missed + 1) * self._period
        self._free, self._waits = now + self._gap, False
        return missed

    def look(self, now: float) -> float:
        """When to see again what is due [s]: an order may come meanwhile, and wait for the gap."""
        return self._free if now < self._free < self.due else self.due
