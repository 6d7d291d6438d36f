"""A driven joint may not come near its end stops; a limp robot may lie and hang on them."""

import numpy as np
import pytest
from gate_cycles import LIMITS, ROBOT, SETTINGS, STAND, entry

from surefoot.config.robot import JOINT_NAMES
from surefoot.hw.gate.end_stops import EndStops

LIE = np.tile(ROBOT.nominal.lie_q, 4)
FOLDED = np.where(np.arange(12) % 3 == 2, LIMITS.lower, LIE)
HANGING = np.where(np.arange(12) % 3 == 2, LIMITS.upper, STAND)


@pytest.fixture
def stops():
    return EndStops(ROBOT, LIMITS, SETTINGS.gate)


def way(start, end, share=1.0, steps=200):
    """Postures from one to part of the way to another."""
    return [start + s * (end - start) for s in np.linspace(0.0, share, steps)]


def broken(stops, postures):
    return [str(found) for q in postures if (found := stops.violation(q, driven=True))]


@pytest.mark.parametrize("joint", range(12), ids=lambda joint: JOINT_NAMES[joint])
@pytest.mark.parametrize("end", ["lower", "upper"])
def test_each_joint_may_come_as_near_as_the_margin(stops, joint, end):
    limit = getattr(LIMITS, end)[joint]
    inside = limit + SETTINGS.gate.stop_margin * (1.0 if end == "lower" else -1.0)
    assert not broken(stops, [STAND, entry(STAND, joint, inside)])
    assert JOINT_NAMES[joint] in broken(stops, [entry(STAND, joint, np.nextafter(inside, limit))])[0]


def test_left_and_right_hips_have_their_own_ranges():
    assert LIMITS.lower[0::3].tolist() == [-0.873, -1.047] * 2
    assert LIMITS.upper[0::3].tolist() == [1.047, 0.873] * 2


@pytest.mark.parametrize("limp", [FOLDED, HANGING, LIE], ids=["folded", "hanging", "lying"])
def test_it_gets_up_from_its_stops_and_is_watched_from_there_on(stops, limp):
    assert stops.violation(limp, driven=False) is None
    assert not broken(stops, way(limp, STAND))
    assert broken(stops, [entry(STAND, 5, LIMITS.lower[5])])


def test_it_sits_down_on_folded_calves(stops):
    assert not broken(stops, way(STAND, LIE)) and not broken(stops, way(LIE, FOLDED))


def test_one_calf_folded_while_another_carries_is_no_lying_robot(stops):
    standing = entry(FOLDED, 2, ROBOT.nominal.lie_q[2] + SETTINGS.gate.lying)
    assert "FR_calf" in broken(stops, [STAND, standing])[0]


def test_other_stops_are_watched_in_a_lying_robot_too(stops):
    assert "FL_thigh" in broken(stops, [LIE, entry(LIE, 1, LIMITS.lower[1])])[0]
