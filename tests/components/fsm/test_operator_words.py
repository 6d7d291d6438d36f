"""From every state the robot sits down as it is told to, and what has been cut stays so until it is damped."""

from dataclasses import replace

import numpy as np
import pytest
from walker import LIE_Q, Walker

from surefoot.bus.messages import ControlMode
from surefoot.config.fsm import Fsm as Settings

IN_AIR = ("SWING", "LANDING")


@pytest.mark.parametrize(
    "state",
    ["STAND_UP", "STAND", "SEND", "OPT", "MOVE", "DETECT_CONTACT", "PROBE", "PROBE_AROUND", "RETURN_SAFE"],
)
def test_from_every_state_a_leg_in_the_air_is_put_down_and_the_robot_sits(state):
    robot = Walker(Settings())
    if state in ("SEND", "OPT"):
        robot.unanswered = ({"SEND": "regions", "OPT": "plan"}[state],)
    if state == "RETURN_SAFE":
        robot.come_to("DETECT_CONTACT")
        robot.command("stop")
    robot.come_to(state)
    robot.run(0.1)
    robot.command("sit: a test")
    assert robot.run(10.0, lambda: robot.state == "SIT_DOWN")
    assert not {status.name for status in robot.status} & set(IN_AIR)
    np.testing.assert_array_equal(robot.reference.joint_to, LIE_Q)
    robot.come_to("DAMP")
    assert robot.reference.reason == "sitting: a test" and robot.reference.mode == ControlMode.DAMP
    robot.run(1.0)
    assert robot.state == "DAMP"


def test_a_leg_that_finds_no_way_back_does_not_keep_the_robot_from_sitting():
    robot = Walker()
    robot.come_to("DETECT_CONTACT")
    robot.run(0.2)
    robot.ground_z[:] = -5.0
    robot.command("sit")
    robot.come_to("SIT_DOWN", robot.settings.put_down_s + 2.0)


def test_one_that_lies_and_feels_no_foot_sits_at_once_when_the_way_back_has_lasted_long_enough():
    robot = Walker()
    robot.come_to("DETECT_CONTACT")
    robot.numb = True
    robot.command("stop")
    robot.run(robot.settings.put_down_s + 1.0)
    assert robot.state == "RETURN_SAFE"
    robot.command("sit")
    assert robot.run(0.05, lambda: robot.state == "SIT_DOWN")


@pytest.mark.parametrize("first, then, rests", [
    ("left", "stand", "STOPPED"),
    ("sit", "stand", "STOPPED"),
    ("left", "right", "STOPPED"),
    ("left", "sit", "DAMP"),
])  # fmt: skip
def test_of_two_wishes_the_last_one_counts(first, then, rests):
    robot = Walker(Settings(goal_m=0.2))
    robot.come_to("MOVE")
    robot.tell(first)
    robot.tell(then)
    assert robot.run(120.0, lambda: robot.state == rests and not robot.fsm._wish)
    if then == "right":
        assert robot.run(120.0, lambda: robot.state == rests and robot.reference.finished)
    robot.run(3.0)
    assert robot.state == rests


def test_in_the_step_in_which_the_estimate_is_lost_a_wish_is_kept_as_is_said():
    robot = Walker()
    robot.come_to("MOVE")
    robot.inbox.deliver("state/estimate", replace(robot.inbox.latest("state/estimate"), valid=False))
    robot.command("stand")
    robot.fsm.step(robot.t, robot.inbox, robot.outbox)
    assert robot.state == "DAMP" and robot.answers[-1].taken
    robot.inbox.clear_new()
    robot.come_to("STAND")


def test_an_estimator_that_began_anew_in_motion_damps_though_its_next_estimate_is_valid():
    robot = Walker()
    robot.come_to("MOVE")
    valid = robot.inbox.latest("state/estimate")
    for estimate in (replace(valid, valid=False), valid):
        robot.inbox.deliver("state/estimate", estimate)
    robot.fsm.step(robot.t, robot.inbox, robot.outbox)
    assert robot.state == "DAMP" and robot.reference.reason.startswith("state/estimate is invalid")


def test_what_follows_a_cut_is_refused_until_it_is_damped():
    robot = Walker()
    robot.come_to("MOVE")
    robot.command("cut")
    robot.run(0.02)
    assert robot.state == "DAMP" and robot.reference.reason == "cut by command"
    robot.command("stand")
    robot.run(0.02)
    assert robot.said[-1] == ("refused", "DAMP", "stand: the torque was cut; command damp first")
    robot.command("damp")
    robot.command("stand")
    robot.come_to("STAND")


def test_a_robot_whose_joints_do_not_follow_has_not_stood_up():
    robot = Walker(command="stand")
    robot.stiff = True
    robot.come_to("STAND_UP")
    robot.come_to("DAMP")
    assert robot.reference.reason.startswith("did not stand up: FL_")
    assert "limit 0.3 rad" in robot.reference.reason
    robot.run(3.0)
    assert robot.state == "DAMP"
