"""From every state the robot sits down as it is told to, and what has been cut stays so until it is damped."""

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
