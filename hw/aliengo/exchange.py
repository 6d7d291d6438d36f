"""How commands go out and states come in: what a driver needs of either way."""

from __future__ import annotations

from typing import Protocol

from surefoot.hw.aliengo.state_feed import TimedState
from surefoot.hw.robot_interface import Sensors

LAST_COMMANDS = 25
"""That damp, when an exchange ends: one may get lost, and the robot may hold the last that it got."""


class Exchange(Protocol):
    """Talks to one robot, from its construction to `close`; it damps until it is given an order."""

    @property
    def newest(self) -> TimedState:
        """All that the robot told in its newest state.

        Raises:
            HardwareFault: it is older than `stale_s`, or nobody answers.
        """

    def read(self) -> Sensors:
        """What of it every robot has, and how old it is. Raises as `newest`."""

    def order(self, packet: bytes | None) -> None:
        """The command of this cycle; None: the safe state."""

    def end_cycle(self) -> None:
        """The caller's cycle is over."""

    def close(self) -> None:
        """Damp and end; closing twice is closing once."""
