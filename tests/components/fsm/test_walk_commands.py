"""What an operator may say of a walk: in which states it is taken, what the robot does, and why it is refused."""

import numpy as np
import pytest
from walker import Walker

from surefoot.bus.messages import LegStatus
from surefoot.components.fsm.words import COMMANDS, NoCommand, read_command
from surefoot.config.fsm import Fsm as Settings

STANCE, SWING, PROBING = LegStatus.STANCE, LegStatus.SWING, LegStatus.PROBING
RL, FL, RR, FR = 2, 0, 3, 1
ON_FOUR_FEET = ("SEND", "OPT", "MOVE")
UNDER_WAY = ("DETECT_CONTACT", "PROBE", "PROBE_AROUND", "LEG_UP")


def walker_in(state, **settings):
    """A robot that walks ahead and has come to a state; its first leg is RL, its next FL."""
    robot = Walker(Settings(**settings))
    if state in ("SEND", "OPT"):
        robot.unanswered = ({"SEND": "regions", "OPT": "plan"}[state],)
    if state == "LEG_UP":
        robot.come_to("PROBE")
        robot.sunk[RL] = 0.04
    robot.come_to(state)
    robot.run(0.1 if state not in ON_FOUR_FEET else 0.02)
    assert robot.state == state
    robot.unanswered = ()
    return robot


def resting_for(word, state="MOVE"):
    robot = walker_in(state)
    assert robot.tell(word).taken
    robot.come_to("STOPPED")
    robot.run(1.2)
    return robot


def without_foothold():
    """A robot whose only candidate for RL gave way: RETURN_SAFE, then STOPPED."""
    robot = Walker(Settings(alternatives=0, put_off=False, probe_around=False))
    robot.come_to("PROBE")
    robot.run(0.3)
    robot.sunk[RL] = 0.04
    robot.come_to("RETURN_SAFE")
    robot.come_to("STOPPED")
    robot.run(1.2)
    return robot


def accepted(robot):
    return [state for kind, state, _ in robot.said if kind == "accepted"]


# To rest, and to go on --------------------------------------------------------------------------------------


@pytest.mark.parametrize("word", ["halt", "pause"])
@pytest.mark.parametrize("state", ON_FOUR_FEET)
def test_where_no_leg_has_left_the_ground_the_robot_rests_at_once(word, state):
    robot = walker_in(state)
    answer = robot.tell(word)
    assert answer.taken and "at once" in answer.words
    assert robot.state == "STOPPED" and robot.reference.reason == f"commanded {word}"
    assert robot.status == [STANCE] * 4 and robot.reference.swing_leg == -1


@pytest.mark.parametrize("word", ["halt", "pause"])
@pytest.mark.parametrize("state", UNDER_WAY)
def test_a_leg_under_way_finishes_its_step_first(word, state):
    robot = walker_in(state)
    answer = robot.tell(word)
    assert answer.taken and "after the step of RL" in answer.words
    assert robot.state == state
    robot.come_to("STOPPED")
    assert len(accepted(robot)) == 1 and robot.status == [STANCE] * 4
    assert robot.reference.reason == f"commanded {word}"
    assert robot.feet[RL, 0] - robot.feet[FL, 0] > -0.75  # RL stands a step ahead


@pytest.mark.parametrize(("state", "leg"), [("MOVE", RL), ("PROBE", FL)])
def test_a_walk_that_was_paused_goes_on_with_the_leg_whose_turn_it_is(state, leg):
    robot = resting_for("pause", state)
    origin = robot.cycle._course._origin_W.copy()
    assert robot.tell("resume").taken
    robot.come_to("MOVE")
    assert robot.reference.leg == leg
    np.testing.assert_array_equal(robot.cycle._course._origin_W, origin)


def test_a_pause_can_be_taken_back_before_the_step_is_over():
    robot = walker_in("DETECT_CONTACT")
    assert robot.tell("pause").taken and robot.tell("resume").taken
    assert robot.run(30.0, lambda: len(accepted(robot)) == 2)
    assert "STOPPED" not in {state for kind, state, _ in robot.said if kind == "transition"}


def test_one_step_and_it_rests_again():
    robot = resting_for("pause")
    for count in (1, 2):
        assert robot.tell("step").taken
        robot.come_to("STOPPED", 30.0)
        assert len(accepted(robot)) == count and robot.reference.reason == "commanded pause"


def test_a_walk_that_was_halted_or_stopped_is_over():
    for word in ("halt", "stop", "stand"):
        robot = resting_for("pause")
        assert robot.tell(word).taken
        answer = robot.tell("resume")
        assert not answer.taken
        assert answer.words == f"resume: the walk is over (commanded {word}); give a direction"
        assert robot.tell("forward").taken
        robot.come_to("MOVE")


def test_a_stop_overrides_a_pause_and_the_leg_goes_back():
    robot = walker_in("DETECT_CONTACT")
    assert robot.tell("pause").taken and robot.tell("stop").taken
    assert robot.state == "RETURN_SAFE"
    robot.come_to("STOPPED")
    assert robot.reference.reason == "commanded stop" and not accepted(robot)


def test_a_pause_skips_no_retreat():
    robot = walker_in("DETECT_CONTACT")
    assert robot.tell("pause").taken
    robot.sunk[FR] = 0.04
    robot.run(0.02)
    assert robot.state == "RETURN_SAFE"
    robot.come_to("STOPPED")
    assert robot.status[FR] == LegStatus.COLLAPSING and robot.reference.support_leg == FR  # leant off
    assert robot.tell("resume").taken
    assert robot.run(30.0, lambda: bool(accepted(robot)))
    assert robot.status == [STANCE] * 4


# Where to ---------------------------------------------------------------------------------------------------


def test_a_new_direction_is_taken_after_the_step():
    robot = walker_in("PROBE", probe_around=False)
    answer = robot.tell("direction 0.5 0.5")
    assert answer.taken and "after the step of RL" in answer.words
    assert robot.run(20.0, lambda: robot.state == "MOVE")
    assert len(accepted(robot)) == 1
    np.testing.assert_allclose(robot.cycle._course.direction, [np.sqrt(0.5)] * 2)


@pytest.mark.parametrize(
    ("words", "why"),
    [
        ("direction", "want two numbers"),
        ("direction 1", "want two numbers"),
        ("direction north 1", "want two numbers"),
        ("direction nan 0", "each number from -1 to 1"),
        ("direction 3 0", "each number from -1 to 1"),
        ("direction 0.01 0.02", "0.02 long, at least 0.1; say halt to stand"),
        ("moonwalk", "commands are stand, sit, forward"),
        ("halt 3", "halt takes no figures"),
    ],
)
def test_what_is_no_command_is_answered_with_what_would_be(words, why):
    with pytest.raises(NoCommand, match=why):
        read_command(words)
    robot = walker_in("MOVE")
    answer = robot.tell(words)
    assert not answer.taken and why in answer.words and robot.state == "MOVE"
    assert robot.said[-1][0] == "refused"


def test_after_a_way_back_the_operator_gives_a_new_direction_and_the_walk_goes_on():
    robot = without_foothold()
    assert "no safe foothold" in robot.reference.reason
    assert robot.tell("direction -1 0").taken
    assert robot.run(20.0, lambda: bool(accepted(robot)))
    assert robot.cycle._course.direction[0] == -1.0


# The foothold of the moment ---------------------------------------------------------------------------------


@pytest.mark.parametrize("state", [*ON_FOUR_FEET, "DETECT_CONTACT", "PROBE", "PROBE_AROUND"])
def test_a_foothold_that_is_skipped_is_followed_by_the_next_candidate(state):
    robot = walker_in(state)
    assert robot.tell("skip").taken
    assert robot.run(3.0, lambda: robot.state == "MOVE" and robot.reference.candidate == 1)
    assert [words for kind, _, words in robot.said if kind == "rejected"] == ["skipped by command"]
    assert robot.run(20.0, lambda: bool(accepted(robot)))
    assert robot.reference.leg in (RL, FL) and robot.status == [STANCE] * 4


def test_a_foot_that_presses_is_unloaded_before_it_is_lifted():
    robot = walker_in("PROBE")
    robot.run(0.5)
    assert robot.observe().normal_force(RL) > 60.0
    robot.tell("skip")
    robot.run(0.07)
    assert robot.state == "PROBE" and robot.status[RL] == PROBING and robot.observe().normal_force(RL) < 15.0
    robot.come_to("LEG_UP")


def test_a_foot_is_not_lifted_while_another_gives_way():
    robot = walker_in("PROBE")
    robot.sunk[FR] = 0.02  # it yields: the press ends by itself
    robot.run(0.02)
    answer = robot.tell("skip")
    assert not answer.taken and "FR yielded 2.0 cm" in answer.words
    robot.run(0.2)
    assert not {SWING, LegStatus.LANDING} & set(robot.status)


def test_a_foot_is_not_lifted_while_the_base_is_outside_the_others():
    robot = walker_in("PROBE")
    robot.com_off = np.array([-0.15, 0.15, 0.0])
    answer = robot.tell("skip")
    assert not answer.taken and "not inside the other three feet: RL stays down" in answer.words


def test_a_collapse_goes_before_a_skip():
    robot = walker_in("PROBE")
    robot.tell("skip")
    robot.sunk[FR] = 0.04
    robot.run(0.02)
    assert robot.status[RL] in (STANCE, PROBING) and robot.status[FR] == LegStatus.COLLAPSING
    assert not {SWING, LegStatus.LANDING} & set(robot.status)


def test_the_last_candidate_that_is_skipped_puts_the_leg_off():
    robot = walker_in("MOVE", alternatives=0)
    assert robot.tell("skip").taken
    robot.come_to("MOVE")
    assert robot.reference.leg == FL


def test_a_foot_presses_again_from_the_first_force():
    robot = walker_in("PROBE")
    robot.run(0.4)
    assert robot.reference.force_index >= 3
    answer = robot.tell("reprobe")
    assert answer.taken and answer.words == "RL presses again from the first force"
    assert robot.state == "PROBE" and robot.reference.force_index == 0
    assert robot.run(20.0, lambda: bool(accepted(robot)))


def test_a_leg_that_found_no_foothold_tries_once_more():
    robot = without_foothold()
    assert robot.tell("reprobe").taken
    robot.come_to("PROBE")
    assert robot.reference.leg == RL and robot.reference.candidate == 0
    assert robot.run(20.0, lambda: bool(accepted(robot)))


# Refused ----------------------------------------------------------------------------------------------------


@pytest.mark.parametrize(
    ("word", "state", "why"),
    [
        ("pause", "STOPPED", "the robot rests already (commanded halt)"),
        ("halt", "STOPPED", "the robot rests already (commanded halt)"),
        ("step", "STOPPED", "the walk is over (commanded halt); give a direction"),
        ("skip", "STOPPED", "no leg is on its way to a foothold in STOPPED"),
        ("reprobe", "STOPPED", "no foot presses in STOPPED"),
        ("resume", "MOVE", "the robot walks; it is taken after a pause (state MOVE)"),
        ("reprobe", "DETECT_CONTACT", "no foot presses in DETECT_CONTACT"),
        ("reprobe", "PROBE_AROUND", "no foot presses in PROBE_AROUND"),
        ("skip", "LEG_UP", "RL has given this foothold up already"),
    ],
)
def test_what_does_not_fit_the_state_is_refused_and_changes_nothing(word, state, why):
    robot = resting_for("halt") if state == "STOPPED" else walker_in(state)
    answer = robot.tell(word)
    assert not answer.taken and answer.words.startswith(f"{word}: {why}")
    assert robot.state == state and robot.said[-1] == ("refused", state, answer.words)


@pytest.mark.parametrize("word", ["skip", "pause", "halt"])
def test_a_leg_that_goes_back_is_not_disturbed(word):
    robot = walker_in("DETECT_CONTACT")
    robot.tell("stop")
    answer = robot.tell(word)
    assert not answer.taken and "commanded stop" in answer.words and robot.state == "RETURN_SAFE"
    robot.come_to("STOPPED")
    assert robot.reference.reason == "commanded stop"


@pytest.mark.parametrize("word", ["halt", "pause", "resume", "step", "skip", "reprobe"])
@pytest.mark.parametrize("posture", ["STAND_UP", "STAND", "DAMP"])
def test_of_a_robot_that_does_not_walk_nothing_is_said_of_a_walk(word, posture):
    robot = Walker(command="stand")
    robot.come_to("STAND" if posture == "DAMP" else posture)
    if posture == "DAMP":
        robot.tell("damp")
    answer = robot.tell(word)
    assert not answer.taken and answer.words == (
        f"{word}: the robot does not walk in {posture}; give a direction first"
    )
    assert robot.state == posture


def test_every_command_is_answered_whatever_the_robot_does():
    robot = Walker(Settings(probe_around=False))
    for word in COMMANDS:
        robot.run(0.5)
        assert robot.tell("direction 0 1" if word == "direction" else word).words


def test_a_robot_that_gets_up_to_walk_and_is_halted_stands():
    robot = Walker(command="forward")
    robot.come_to("STAND_UP")
    assert robot.tell("halt").words == "the robot does not set off"
    robot.come_to("STAND")
    robot.run(1.0)
    assert robot.state == "STAND"


@pytest.mark.parametrize("word", ["halt", "pause"])
def test_a_robot_that_was_told_to_sit_is_not_kept_from_it(word):
    robot = walker_in("DETECT_CONTACT")
    robot.tell("sit")
    assert not robot.tell(word).taken
    robot.come_to("DAMP")
    assert "sitting" in robot.reference.reason


# Held up ----------------------------------------------------------------------------------------------------


def held_up(robot, seconds):
    """Stopped itself for a while, as by SIGSTOP: the robot has been held by its controllers."""
    robot.t += seconds
    robot.tick()


@pytest.mark.parametrize("state", ["SEND", "MOVE", "DETECT_CONTACT", "PROBE", "PROBE_AROUND", "LEG_UP"])
def test_a_state_machine_that_was_held_up_ends_the_walk(state):
    robot = walker_in(state)
    held_up(robot, 1.0)
    robot.come_to("STOPPED")
    assert robot.reference.reason == "the state machine was held up for 1.0 s"
    assert robot.tell("forward").taken


def test_a_delay_that_the_controllers_bear_ends_nothing():
    robot = walker_in("PROBE")
    held_up(robot, 0.05)
    robot.run(0.5)
    assert robot.state == "PROBE"


def test_a_robot_that_rests_goes_on_resting():
    robot = Walker(command="stand")
    robot.come_to("STAND")
    held_up(robot, 1.0)
    assert robot.state == "STAND"


def test_a_walk_that_is_paused_can_be_resumed_after_it():
    robot = resting_for("pause")
    held_up(robot, 1.0)
    assert robot.state == "STOPPED" and robot.tell("resume").taken
