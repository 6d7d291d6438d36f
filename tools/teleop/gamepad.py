"""What the buttons and the stick of a gamepad say, by the standard mapping of browsers."""

from __future__ import annotations

from collections.abc import Collection
from math import atan2, cos, hypot, pi, radians, remainder, sin
from typing import NamedTuple

from surefoot.tools.teleop.driver import Driver
from surefoot.tools.teleop.keys import KEYS


class Button(NamedTuple):
    """A button and its meaning.

    Attributes:
        name: on the gamepads of two makers.
        key: of the terminal's keys, which it stands for.
    """

    name: str
    key: str


BUTTONS = {
    0: Button("A / ✕", " "),
    1: Button("B / ○", "S"),
    2: Button("X / □", "k"),
    3: Button("Y / △", "r"),
    5: Button("R1", "n"),
    6: Button("L2", "j"),
    7: Button("R2", "u"),
    9: Button("Start", "p"),
    12: Button("cross ↑", "w"),
    13: Button("cross ↓", "s"),
    14: Button("cross ←", "a"),
    15: Button("cross →", "d"),
}
"""By number; those of the two sticks and the maker's own say nothing."""

HELD, CUTS = 4, 8
"""L1 has to be held already when Select is pressed: only both together cut."""

TABLE = (
    ("left stick", "walk where it points; halt when it is let go"),
    *((button.name, KEYS[button.key].label) for button in BUTTONS.values()),
    ("L1 held, then Select", KEYS["X"].label),
)
"""What each does, for people."""

_LEADS, _RESTS = 0.5, 0.3  # the stick's way from the middle; between them it goes on with what it did
_TURNS = radians(15.0)  # under way the robot ends its step before it turns: a hand that trembles does not stop it
_KEEP = ("k", "r")  # of a foothold, not of the walk: the stick goes on to lead
_END = ("S", "j", "X")  # stop, sit, cut: never refused, and nothing is left to halt


class Gamepad:
    """A gamepad in a person's hand: a button speaks once as it goes down, the stick where it points.

    The stick leads only from the middle on: one that is held when the gamepad is first seen, or when another
    command comes between, says nothing more until it is let go. Its direction waits until all is answered that
    was said before; the halt of a stick that is let go waits for nothing.

    Attributes:
        leads: the stick has sent the robot somewhere and was not let go since.
    """

    def __init__(self, driver: Driver):
        """`driver`: says what the hand does."""
        self._driver = driver
        self._down: frozenset[int] | None = None
        self._towards = 0.0  # [rad], from ahead to the left
        self._ready = self.leads = False

    def feel(self, stick: tuple[float, float], down: Collection[int]) -> None:
        """How it is held now.

        Args:
            stick: the left one, to the right and down, each from -1 to 1, as browsers have it.
            down: the buttons that are pressed, by number.
        """
        before, self._down = self._down, frozenset(down)
        if before is not None:
            for number in sorted(self._down - before):
                self._press(number, before)
        self._lead(x=-stick[1], y=-stick[0])

    def let_go(self) -> None:
        """It is unplugged: nobody can let go of its stick any more."""
        self._down, self._ready = None, False
        self._halt()

    def give_way(self, key: str) -> None:
        """A key or a button that says something else: the stick leads again after it was in the middle."""
        if key not in _KEEP:
            self._ready = False
        if key in _END:
            self.leads = False

    def _press(self, number: int, held: Collection[int]) -> None:
        if number == CUTS and HELD in held:
            self.give_way("X")
            self._driver.say("cut")
        elif number in BUTTONS:
            self.give_way(BUTTONS[number].key)
            self._driver.press(BUTTONS[number].key)

    def _lead(self, x: float, y: float) -> None:
        """x ahead, y to the left."""
        length, towards = hypot(x, y), atan2(y, x)
        if length < _RESTS:
            self._ready = True
            self._halt()
        elif self._ready and length > _LEADS and not self._driver.waits and self._is_new(towards):
            self.leads, self._towards = True, towards
            self._driver.say(f"direction {cos(towards):z.2f} {sin(towards):z.2f}")

    def _is_new(self, towards: float) -> bool:
        return not self.leads or abs(remainder(towards - self._towards, 2.0 * pi)) > _TURNS

    def _halt(self) -> None:
        if self.leads:
            self.leads = False
            self._driver.say("halt")
