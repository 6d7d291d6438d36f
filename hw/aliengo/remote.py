"""The wireless remote, whose 40 bytes travel in every state packet."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass
from enum import IntFlag
from math import isnan

import numpy as np

from surefoot.config.aliengo import Chords
from surefoot.hw.robot_interface import Stop

_BYTES = np.dtype(
    {
        "names": ["buttons", "lx", "rx", "ry", "ly"],
        "formats": ["<u2", "<f4", "<f4", "<f4", "<f4"],
        "offsets": [2, 4, 8, 12, 20],
        "itemsize": 40,
    }
)
_STICKS = ("lx", "ly", "rx", "ry")


class Button(IntFlag):
    """Buttons of the remote, a bit each."""

    R1 = 1 << 0
    L1 = 1 << 1
    START = 1 << 2
    SELECT = 1 << 3
    R2 = 1 << 4
    L2 = 1 << 5
    F1 = 1 << 6
    F2 = 1 << 7
    A = 1 << 8
    B = 1 << 9
    X = 1 << 10
    Y = 1 << 11
    UP = 1 << 12
    RIGHT = 1 << 13
    DOWN = 1 << 14
    LEFT = 1 << 15


_OPPOSITE = (Button.UP | Button.DOWN, Button.LEFT | Button.RIGHT)
"""No thumb holds both: such bytes are no remote's."""


@dataclass(frozen=True)
class Remote:
    """What is held on the remote; nothing when it is off."""

    buttons: Button = Button(0)
    lx: float = 0.0  # left stick, -1 to 1, right is positive
    ly: float = 0.0  # up is positive
    rx: float = 0.0  # right stick
    ry: float = 0.0


class StopChords:
    """Which buttons, all held together, stop the robot; others may be held beside them."""

    def __init__(self, chords: Chords):
        self._settle, self._cut = buttons_of(chords.settle), buttons_of(chords.cut)

    def held(self, remote: Remote) -> Stop:
        """What is asked for; to cut goes before to settle."""
        buttons = remote.buttons
        if any(both in buttons for both in _OPPOSITE):
            return ""
        if self._cut and self._cut in buttons:
            return "cut"
        return "settle" if self._settle and self._settle in buttons else ""


def buttons_of(names: Iterable[str]) -> Button:
    """The buttons of these names, held together."""
    held = Button(0)
    for name in names:
        held |= Button[name]
    return held


def decode_remote(data: np.ndarray) -> Remote:
    """The remote from its (40,) bytes.

    A stick that is not a number counts as 0 and one beyond its end as at its end: what a remote that is off leaves
    there must not cost the motors' state in the same packet.
    """
    fields = data.view(_BYTES)[0]
    return Remote(Button(int(fields["buttons"])), **{name: _stick(float(fields[name])) for name in _STICKS})


def encode_remote(remote: Remote) -> np.ndarray:
    """The (40,) bytes of a remote; those without a meaning are zero."""
    fields = np.zeros(1, _BYTES)
    fields["buttons"] = int(remote.buttons)
    for name in _STICKS:
        fields[name] = getattr(remote, name)
    return fields.view(np.uint8)


def _stick(value: float) -> float:
    return 0.0 if isnan(value) else min(max(value, -1.0), 1.0)
