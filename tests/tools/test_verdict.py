"""When a run is over and what it advises."""

from dataclasses import replace

import pytest

from surefoot.bus.messages import HardwareState, MotionReference
from surefoot.hw.gate.gate import FREED_BY
from surefoot.tools.picture import Picture
from surefoot.tools.verdict import verdict


def judged(interactive=False, seconds=0.0, terrain="planks", commands=("forward",), **reference):
    picture = Picture(reference=MotionReference(t=5.0, **reference))
    for command in commands:
        picture.note_command(command)
    return verdict(picture, terrain, seconds, interactive)


def test_nothing_is_said_before_anything_is_heard_and_while_the_robot_walks():
    assert not verdict(Picture(), "flat", 1.0, False).over
    assert judged(state="PROBE").reason == ""


def test_the_goal_and_the_time_are_good_ends():
    assert judged(state="STOPPED", finished=True).good
    assert judged(state="PROBE", seconds=5.0).good
    assert not judged(state="PROBE", seconds=5.1).over


def test_only_ground_walked_forward_is_crossed():
    finished = {"state": "STOPPED", "finished": True}
    assert judged(**finished).reason == "platform crossed"
    assert judged(commands=("backward", "stop", "forward", "stand"), **finished).reason == "platform crossed"
    assert judged(commands=("forward", "left"), **finished).reason == "goal reached"
    assert judged(terrain="flat", **finished).reason == "goal reached"
    assert judged(terrain="rocks", **finished).reason == "rocks crossed"


@pytest.mark.parametrize("interactive", [True, False])
def test_a_person_who_damps_the_robot_ends_the_run_and_a_start_in_damping_does_not(interactive):
    end = judged(interactive, state="DAMP", reason="commanded")
    assert end.over and end.good and end.reason == "damped by command"
    for reason in ("waiting for a command", "sitting"):
        assert not judged(interactive, state="DAMP", reason=reason).over


@pytest.mark.parametrize(
    "reason",
    [
        "tilt 0.80 rad, limit 0.7 rad: fallen",
        "state/estimate is missing or stale: why?",
        "state/estimate is invalid: why?",
    ],
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


def test_to_stop_in_a_trap_is_what_the_robot_should_do():
    stop = {"state": "STOPPED", "reason": "no safe foothold among the alternatives"}
    assert judged(terrain="trap", **stop).good and not judged(terrain="rocks", **stop).good


def test_a_gate_that_has_latched_waits_for_a_person_where_there_is_one():
    hardware = HardwareState(damping=True, gate=f"damped too long to go on (wbc is away): {FREED_BY}")

    def lies(state, interactive, gate=hardware):
        picture = Picture(reference=MotionReference(t=5.0, state=state), hardware=gate)
        return verdict(picture, "planks", 0.0, interactive)

    assert lies("RETURN_SAFE", interactive=False).over and not lies("RETURN_SAFE", interactive=True).over
    assert "wbc is away" in lies("RETURN_SAFE", interactive=True).reason
    assert not lies("DAMP", interactive=False).over, "a person has seen to it"
    passes_over = replace(hardware, gate="command is 60 ms old, limit 50 ms: is wbc running?")
    assert not lies("RETURN_SAFE", interactive=False, gate=passes_over).over
