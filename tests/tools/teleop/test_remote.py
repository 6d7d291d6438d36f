"""Every method of the remote is a command on the bus, and gives back what became of it."""

from concurrent.futures import ThreadPoolExecutor

import pytest
from driven import Driven

from surefoot.bus.service_keys import REQUEST
from surefoot.tools.cli import main
from surefoot.tools.teleop.remote import Remote


@pytest.fixture
def driven():
    """Makes stacks that end with the test."""
    made = []

    def make(**settings):
        made.append(Driven(**settings))
        made[-1].come_to("STAND")
        return made[-1]

    yield make
    for each in made:
        each.close()


@pytest.fixture
def remote_of():
    """Makes remotes that end with the test."""
    made = []

    def make(stack, **figures):
        session = stack.join()
        made.append((session, Remote(session, **figures)))
        return made[-1][1]

    yield make
    for session, remote in made:
        remote.close()
        session.close()


def test_a_walk_from_the_first_direction_to_the_end(driven, remote_of):
    stack = driven(probe_around=False)
    remote = remote_of(stack)
    stack.hold_in("DETECT_CONTACT")
    assert remote.direction(1.0, 0.0).taken
    stack.wait_held()
    for say, words in (
        (remote.pause, "after the step of RL; resume goes on"),
        (remote.resume, "the pause is taken back: the walk goes on after this step"),
        (remote.pause, "after the step of RL; resume goes on"),
    ):
        assert say().words == words
    stack.go_on()
    stack.come_to("STOPPED")
    stack.hold_in("PROBE")
    assert remote.step_once().words == "one step, then a pause again"
    stack.wait_held()
    assert remote.reprobe().words == "FL presses again from the first force"
    assert remote.skip_foothold().taken
    stack.hold_in("LEG_UP")
    stack.wait_held()
    assert remote.stop().taken
    stack.go_on()
    stack.come_to("STOPPED")
    assert remote.sit().taken
    stack.come_to("DAMP")
    assert remote.stand().words == "the robot stands up first"
    assert remote.cut().taken and not remote.stand().taken and remote.damp().taken
    assert stack.commands[:2] == ["direction 1.000 0.000", "pause"]


def test_what_is_refused_says_why(driven, remote_of):
    remote = remote_of(driven())
    assert remote.skip_foothold().words == "skip: the robot does not walk in STAND; give a direction first"
    assert "each number from -1 to 1" in remote.direction(0.0, 7.0).words


def test_what_the_desk_does_not_pass_on_is_answered_too(driven, remote_of):
    stack = driven(heartbeat_s=30.0)
    answer = remote_of(stack, beats=False).direction(1.0, 0.0)
    assert not answer.taken and "no heartbeat yet; start surefoot heartbeat" in answer.words
    assert remote_of(stack).direction(1.0, 0.0).taken  # that one beats


def test_a_robot_whose_remote_is_closed_sits_down(driven, remote_of):
    stack = driven(heartbeat_s=4.0)
    remote = remote_of(stack)
    assert remote.direction(1.0, 0.0).taken
    stack.come_to("MOVE")
    remote.close()
    stack.come_to("DAMP")
    assert "sit: no heartbeat for 4 s" in stack.commands


def test_no_answer_keeps_another_command(driven, remote_of):
    stack = driven()
    remote = remote_of(stack)
    stack._ended.set()  # nobody obeys any more
    stack._thread.join()
    with ThreadPoolExecutor(2) as pool:
        answers = list(pool.map(remote.say, ("pause", "stop")))
    assert [answer.taken for answer in answers] == [False, False]
    assert all("no answer in 3 s: is fsm running" in answer.words for answer in answers)


@pytest.mark.parametrize(("command", "word"), [("stop", "sit"), ("cut", "cut")])
def test_stop_and_cut_tell_what_became_of_them(driven, capsys, command, word):
    stack = driven()
    assert main([command, "--namespace", stack.namespace]) == 0
    assert stack.commands == [word]
    stack.come_to("DAMP")
    told, answer = capsys.readouterr().out.splitlines()
    assert told.endswith(f": {word}") and "refused" not in answer


@pytest.mark.parametrize(("command", "word"), [("stop", b"sit"), ("cut", b"cut")])
def test_a_stop_that_nobody_takes_is_said_all_the_same_and_is_no_success(driven, capsys, command, word):
    stack = driven()
    stack._ended.set()  # nobody obeys any more
    stack._thread.join()
    assert main([command, "--namespace", stack.namespace]) == 1
    assert "no answer in 3 s: is fsm running" in capsys.readouterr().out
    assert list(stack._desk._requests) == [(REQUEST, word)]


def test_two_remotes_get_each_their_own_answer(driven, remote_of):
    stack = driven()
    one, other = remote_of(stack), remote_of(stack)
    assert one.direction(1.0, 0.0).taken
    with ThreadPoolExecutor(2) as pool:
        halt, skip = pool.submit(one.halt), pool.submit(other.say, "moonwalk")
    assert halt.result().words.endswith("the walk is over") and "unknown command 'moonwalk'" in skip.result().words
