"""The arrows of Fig. 6: what follows on what a phase has found."""

from __future__ import annotations

from dataclasses import dataclass
from enum import Enum, auto

from surefoot.components.fsm.state import State


class Fork(Enum):
    """Where the way on is for another phase to tell."""

    CONTACT = auto()
    """The foot has met ground: is it to be probed?"""
    BROKEN_OFF = auto()
    """The press must end: what has the foothold borne so far?"""
    UNFIT = auto()
    """This foothold will not do: is there an alternative?"""
    BACK = auto()
    """The leg stands where it stood before: go on, or stop?"""


class End(Enum):
    """Where there is nothing to tell: the robot stands."""

    NO_LEG = auto()
    """No leg has a step to make."""
    LEAN = auto()
    """The ground under a foot gives way while the robot rests: it goes on resting, without that foot."""


@dataclass(frozen=True)
class Arrow:
    """Where to, and why.

    SEND, MOVE, LEG_UP and RETURN_SAFE, to which phases other than their own point, are begun when the arrow is
    followed; a phase that points to another state has begun it.
    """

    to: State | Fork | End
    why: str = ""
