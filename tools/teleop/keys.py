"""What each key of `surefoot drive` says."""

from __future__ import annotations

from typing import NamedTuple


class Key(NamedTuple):
    """A key and its meaning.

    Attributes:
        words: the command.
        label: for the help line.
    """

    words: str
    label: str


KEYS = {
    "w": Key("forward", "ahead"),
    "s": Key("backward", "back"),
    "a": Key("left", "left"),
    "d": Key("right", "right"),
    " ": Key("halt", "halt after the step"),
    "p": Key("pause", "pause, resume"),
    "n": Key("step", "one step"),
    "k": Key("skip", "skip foothold"),
    "r": Key("reprobe", "press again"),
    "u": Key("stand", "stand"),
    "j": Key("sit", "sit"),
    "S": Key("stop", "stop at once"),
    "X": Key("cut", "cut"),
}
"""By the character that is typed."""

ARROWS = {"up": "w", "down": "s", "left": "a", "right": "d"}
"""The arrow keys say what these characters do."""

LEAVE, SURE = "q", "y"
"""Ends the program; confirms a cut."""
