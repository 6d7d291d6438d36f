"""What people ask for, at a terminal or at the robot, and what is done when they are gone, goes one way."""

import pytest

from surefoot.bus.codec import decode
from surefoot.bus.messages import OperatorCommand
from surefoot.bus.service_keys import BEAT, REQUEST
from surefoot.components.operator_desk import OperatorDesk
from surefoot.config.deployment import Deployment
from surefoot.config.operator import Operator


class Bus:
    """In place of the session."""

    def __init__(self):
        self.said, self.ears = [], {}

    def put(self, key, payload, lossless=True):
        if key == "operator/command":
            self.said.append(decode(OperatorCommand, payload))

    def subscribe(self, key, receive):
        self.ears[key] = receive

    def serve(self, key, answer):
        pass

    serve_each = serve


class Side:
    """A desk and the operator's side of it."""

    t = 50.0

    def __init__(self, heartbeat_s):
        self.bus, self.dropped, self.refused = Bus(), [], []
        deployment = Deployment(operator=Operator(heartbeat_s=heartbeat_s))
        self.desk = OperatorDesk(self.bus, self.dropped.append, self._on_refusal, deployment)

    def _on_refusal(self, key, words):
        self.refused.append(words)

    def say(self, key, text=""):
        self.bus.ears[key](key, text.encode())

    def commands(self, t=0.0, at_robot=()):
        before = len(self.bus.said)
        count = self.desk.publish(t, at_robot)["operator/command"]
        new = self.bus.said[before:]
        assert count == len(new) and [each.seq for each in new] == list(range(before, before + count))
        return [(each.t, each.command) for each in new]


@pytest.fixture
def side(monkeypatch):
    """Makes a side whose time stands still but where a test lets it go on."""

    def make(heartbeat_s=0.0):
        one = Side(heartbeat_s)
        monkeypatch.setattr(one.desk._heartbeat, "_clock", lambda: one.t)
        return one

    return make


def test_what_is_asked_is_dated_and_what_is_no_word_is_dropped(side):
    one = side()
    one.say(REQUEST, "forward")
    one.say(REQUEST, "x" * 65)
    assert one.commands(3.0) == [(3.0, "forward")] and "is no command" in one.dropped[0] and not one.refused


def test_what_is_asked_at_the_robot_goes_first(side):
    one = side()
    one.say(REQUEST, "forward")
    assert one.commands(1.0, ["cut: buttons of the remote"]) == [
        (1.0, "cut: buttons of the remote"),
        (1.0, "forward"),
    ]


def test_without_the_heartbeat_the_robot_is_told_to_sit_once_and_obeys_no_command_to_move(side):
    one = side(heartbeat_s=2.0)
    one.say(BEAT)
    one.say(REQUEST, "forward")
    assert one.commands() == [(0.0, "forward")]
    one.t += 2.1
    assert one.commands(0.2) == [(0.2, "sit: no heartbeat for 2 s")] and one.commands(0.3) == []
    for word in ("stand", "forward", "sit", "damp", "cut"):
        one.say(REQUEST, word)
    assert [command for _, command in one.commands()] == ["sit", "damp", "cut"]
    assert [words.split(";")[0] for words in one.refused] == [
        f"refused operator/request: {word}: no heartbeat for 2 s" for word in ("stand", "forward")
    ]
    assert not one.dropped  # a request that is turned down is no bad message
    one.say(BEAT)
    assert one.commands() == []  # nothing moves by itself when it is back
    one.say(REQUEST, "stand")
    assert one.commands() == [(0.0, "stand")]


def test_before_the_first_heartbeat_nothing_moves_either(side):
    one = side(heartbeat_s=2.0)
    one.say(REQUEST, "stand")
    assert one.commands() == [] and "no heartbeat yet; start surefoot heartbeat" in one.refused[0]


def test_what_stops_the_robot_passes_without_a_heartbeat_whatever_its_reason(side):
    one = side(heartbeat_s=2.0)
    for command in ("sit: mpc has ended", "cut", "stand: sit"):
        one.say(REQUEST, command)
    assert [command for _, command in one.commands()] == ["sit: mpc has ended", "cut"]
    assert "stand: sit: no heartbeat" in one.refused[0]
