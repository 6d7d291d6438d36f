"""io sees to it that a robot that is told to sit, or to damp, ends up damped."""

import numpy as np
import pytest

from surefoot.bus.messages import JointCommand, OperatorCommand
from surefoot.components.io.operator_hand import OperatorHand

SETTLE_S = 5.0
DRIVES = JointCommand(valid=True, kp=np.full(12, 100.0))
DAMPS = JointCommand(valid=True, kd=np.full(12, 3.0))


class Gate:
    """Notes what it is told."""

    def __init__(self):
        self.told = []

    def cut(self, why):
        self.told.append(("cut", why))

    def damp(self, why):
        self.told.append(("damp", why))

    def free(self):
        self.told.append(("free",))


@pytest.fixture
def hand():
    return OperatorHand(Gate(), SETTLE_S)


def hear(hand, *commands, t=0.0):
    for command in commands:
        hand.hear(OperatorCommand(valid=True, command=command), t)


def test_one_that_is_still_driven_after_its_time_is_damped_once(hand):
    hear(hand, "sit: no heartbeat for 2 s", t=1.0)
    hear(hand, "sit", t=4.0)  # said again, it gets no more time
    hand.watch(DRIVES, 5.9)
    assert hand._gate.told == []
    hand.watch(DRIVES, 6.0)
    hand.watch(DRIVES, 7.0)
    assert hand._gate.told == [("damp", "told to settle 5 s ago and still driven: is fsm running?")]


@pytest.mark.parametrize("then", ["halt", "pause", "skip", "damp", "hold", "forwards", "direction"])
def test_a_word_that_does_not_take_the_sit_back_gives_it_no_more_time(hand, then):
    hear(hand, "sit", t=1.0)
    hand.watch(DRIVES, 3.9)
    hear(hand, then, t=4.0)
    hand.watch(DRIVES, 6.0)
    assert hand._gate.told[-1:] == [("damp", "told to settle 5 s ago and still driven: is fsm running?")]


def test_one_that_is_told_to_damp_and_is_driven_on_is_damped(hand):
    hear(hand, "damp", t=1.0)
    hand.watch(DRIVES, 6.0)
    assert hand._gate.told[-1] == ("damp", "told to settle 5 s ago and still driven: is fsm running?")


def test_one_that_is_held_after_it_was_damped_is_not(hand):
    hear(hand, "sit", t=1.0)
    hand.watch(DAMPS, 3.0)
    hear(hand, "hold", t=4.0)
    hand.watch(DRIVES, 30.0)
    assert hand._gate.told == []


@pytest.mark.parametrize("then", ["stand", "forward", "direction 1 0", "stop"])
def test_one_that_sits_or_is_told_otherwise_is_not(hand, then):
    hear(hand, "sit")
    hand.watch(DAMPS, 6.0)
    hear(hand, "sit", then, t=10.0)
    hand.watch(DRIVES, 30.0)
    assert hand._gate.told == []


def test_a_cut_has_its_reason_and_is_taken_back_by_damp_alone(hand):
    hear(hand, "cut: a test", "sit", "stand", "damp", "cut")
    assert hand._gate.told == [("cut", "a test"), ("free",), ("cut", "by command")]
