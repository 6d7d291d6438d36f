"""What a hand on a gamepad says, and what it does not."""

import time
from threading import Event

import pytest

from surefoot.components.fsm.words import taken
from surefoot.tools.teleop.driver import Driver
from surefoot.tools.teleop.gamepad import Gamepad

MIDDLE, AHEAD, LEFT = (0.0, 0.0), (0.0, -1.0), (-1.0, 0.0)
A, B, X, L1, SELECT, UP = 0, 1, 2, 4, 8, 12


class Hand:
    """A gamepad that was seen at rest.

    Attributes:
        said: the commands, in their order.
        answers: set while what is said is answered.
    """

    def __init__(self):
        self.said, self.answers = [], Event()
        self.answers.set()
        self.driver = Driver(self._ask, lambda: False)
        self.gamepad = Gamepad(self.driver)
        self.gamepad.feel(MIDDLE, [])

    def _ask(self, words):
        self.said.append(words)
        return lambda: self.answers.wait() and taken("so be it")

    def feel(self, stick=MIDDLE, *down):
        self.gamepad.feel(stick, down)
        self.settle()

    def settle(self):
        while self.answers.is_set() and self.driver.waits:
            time.sleep(0.001)


@pytest.fixture
def hand():
    hand = Hand()
    yield hand
    hand.answers.set()


def test_a_button_speaks_once_as_it_goes_down(hand):
    for down in ([UP], [UP], [UP, B], [UP], [UP, B]):
        hand.feel(MIDDLE, *down)
    assert hand.said == ["forward", "stop", "stop"]


def test_the_stick_walks_where_it_points_and_halts_in_the_middle(hand):
    for stick in (AHEAD, LEFT, (0.7, 0.7), MIDDLE, MIDDLE):
        hand.feel(stick)
    assert hand.said == ["direction 1.00 0.00", "direction 0.00 1.00", "direction -0.71 -0.71", "halt"]


def test_a_hand_that_trembles_says_nothing_new(hand):
    for stick in ((0.0, -0.4), (0.2, 0.1), AHEAD, (0.2, -0.9), (-0.2, -0.9), (0.0, -0.4), AHEAD, (0.0, -0.4)):
        hand.feel(stick)
    assert hand.said == ["direction 1.00 0.00"]


def test_a_direction_waits_for_answers_and_neither_a_halt_nor_a_stop_does(hand):
    hand.answers.clear()
    hand.feel(AHEAD)
    hand.feel(LEFT)
    hand.feel(MIDDLE)
    hand.feel(AHEAD)
    hand.feel(AHEAD, B)
    hand.feel(MIDDLE)
    assert hand.said == ["direction 1.00 0.00", "halt", "stop"]
    hand.answers.set()
    hand.settle()
    hand.feel(AHEAD)
    assert hand.said[3:] == ["direction 1.00 0.00"]


def test_what_is_said_again_after_something_else_is_no_repetition(hand):
    hand.answers.clear()
    for key in ("S", "S", "w", "S"):
        hand.driver.press(key)
    assert hand.said == ["stop", "forward", "stop"]


def test_a_cut_needs_the_shoulder_first(hand):
    for down in ([SELECT], [], [L1, SELECT], [L1]):
        hand.feel(MIDDLE, *down)
    assert hand.said == []
    hand.feel(MIDDLE, L1, SELECT)
    assert hand.said == ["cut"]


def test_after_a_stop_the_stick_leads_from_the_middle_only(hand):
    for stick, *down in ((AHEAD,), (AHEAD, B), (AHEAD,), (LEFT,), (MIDDLE,), (LEFT,)):
        hand.feel(stick, *down)
    assert hand.said == ["direction 1.00 0.00", "stop", "direction 0.00 1.00"]


def test_a_foothold_is_skipped_while_the_stick_leads_on(hand):
    for stick, *down in ((AHEAD,), (AHEAD, X), (LEFT,)):
        hand.feel(stick, *down)
    assert hand.said == ["direction 1.00 0.00", "skip", "direction 0.00 1.00"]


def test_one_that_is_unplugged_halts_what_its_stick_led_and_begins_anew(hand):
    hand.feel(AHEAD, A)
    hand.gamepad.let_go()
    hand.gamepad.let_go()
    hand.feel(AHEAD, B)
    assert hand.said == ["halt"]
    hand.feel()
    hand.feel(AHEAD)
    hand.gamepad.let_go()
    assert hand.said == ["halt", "direction 1.00 0.00", "halt"]
