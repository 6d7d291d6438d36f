"""When a run is over and what it advises."""

from dataclasses import replace

import pytest

from surefoot.bus.messages import MotionReference
from surefoot.tools.picture import Picture
from surefoot.tools.verdict import verdict


def judged(interactive=False, seconds=0.0, **reference):
    return verdict(Picture(reference=MotionReference(t=5.0, **reference)), seconds, interactive)


def test_nothing_is_said_before_anything_is_heard_and_while_the_robot_walks():
    assert not verdict(Picture(), 1.0, False).over
    assert judged(state="PROBE").reason == ""


def test_the_goal_and_the_time_are_good_ends():
    assert judged(state="STOPPED", finished=True).good
    assert judged(state="PROBE", seconds=5.0).good
    assert not judged(state="PROBE", seconds=5.1).over


@pytest.mark.parametrize(
    "reason", ["tilt 0.80 rad, limit 0.7 rad: fallen", "state/estimate is missing or stale: why?"]
)
def test_a_robot_that_lies_ends_the_run_with_advice(reason):
    end = judged(state="DAMP", reason=reason, interactive=True)
    assert end.over and not end.good and end.advice and reason in end.reason


def test_a_stop_waits_for_a_person_where_there_is_one():
    stop = {"state": "STOPPED", "reason": "no safe foothold among the alternatives"}
    waits, ends = judged(interactive=True, **stop), judged(**stop)
    assert not waits.over and ends.over and not ends.good
    assert "surefoot command backward" in waits.advice and waits.advice == ends.advice
    assert judged(state="STOPPED", reason="commanded stop") == replace(judged(state="PROBE"))
