"""A joint may be at its end stop, where legs fold, hang and straighten; beyond it no joint can be."""

import numpy as np
import pytest
from gate_cycles import LIMITS, ROBOT, SETTINGS, STAND, entry

from surefoot.config.deployment import Deployment
from surefoot.config.robot import JOINT_NAMES
from surefoot.hw.gate.end_stops import EndStops

LIE = np.tile(ROBOT.nominal.lie_q, 4)
FOLDED = np.where(np.arange(12) % 3 == 2, LIMITS.lower, LIE)
HANGING = np.where(np.arange(12) % 3 == 2, LIMITS.upper, STAND)


@pytest.fixture
def stops():
    return EndStops(LIMITS, SETTINGS.gate)


@pytest.mark.parametrize("joint", range(12), ids=lambda joint: JOINT_NAMES[joint])
@pytest.mark.parametrize("end", ["lower", "upper"])
def test_each_joint_may_read_as_far_beyond_its_range_as_is_set(stops, joint, end):
    limit, away = getattr(LIMITS, end)[joint], -1.0 if end == "lower" else 1.0
    last = limit + away * SETTINGS.gate.beyond_stop
    assert stops.violation(entry(STAND, joint, last), driven=True) is None
    found = stops.violation(entry(STAND, joint, np.nextafter(last, away * np.inf)), driven=True)
    assert JOINT_NAMES[joint] in str(found)


def test_left_and_right_hips_have_their_own_ranges():
    assert LIMITS.lower[0::3].tolist() == [-0.873, -1.047] * 2
    assert LIMITS.upper[0::3].tolist() == [1.047, 0.873] * 2


@pytest.mark.parametrize("posture", [FOLDED, HANGING, LIE], ids=["folded", "hanging", "lying"])
def test_legs_at_their_stops_may_be_driven(stops, posture):
    assert stops.violation(posture, driven=True) is None


def test_a_leg_as_long_as_the_state_machine_may_ask_for_is_inside(stops):
    length, links = Deployment().fsm.leg_length_max_m, ROBOT.thigh_length
    knee = -2.0 * np.arccos(length / (2.0 * links))  # thigh and calf are alike
    assert stops.violation(entry(STAND, 2, knee), driven=True) is None


def test_a_robot_that_is_only_damped_is_not_watched(stops):
    assert stops.violation(entry(STAND, 2, 1.0), driven=False) is None
