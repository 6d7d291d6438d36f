"""`surefoot tune` on a running stack: a change is taken, listed, shown and saved, or refused with its reason."""

import json

import pytest
from driven import Driven

from surefoot.config.deployment import load_deployment
from surefoot.tools.cli import main
from surefoot.tools.stack_watch import StackWatch
from surefoot.tools.teleop.remote import Remote


@pytest.fixture
def stack():
    made = Driven()
    made.come_to("STAND")
    yield made
    made.close()


@pytest.fixture
def tune(stack, capsys):
    def call(*words):
        code = main(["tune", *words, "--namespace", stack.namespace])
        told = capsys.readouterr()
        return code, told.out + told.err

    return call


def test_a_change_is_told_and_acts(stack, tune):
    assert tune("fsm.swing_s", "0.4") == (0, "fsm.swing_s=0.4 from the next step on\n")
    stack.wait(lambda: stack.robot.fsm.deployment.fsm.swing_s == 0.4)
    assert tune("wbc.wrench_weight", "[1, 1, 2, 2, 2, 3]")[0] == 0


@pytest.mark.parametrize(
    ("key", "value", "why"),
    [
        ("fsm.swing_s", "0.01", "refused: fsm.swing_s = 0.01: out of range, allowed 0.05 to 10"),
        ("hw.kp_max", "1000", "refused: hw.kp_max: not to be changed while the robot runs"),
        ("wbc.joint_kp", "1999", "is above hw.kp_max"),
    ],
)
def test_what_is_out_of_bounds_is_refused_with_the_words_of_the_configuration(stack, tune, key, value, why):
    code, told = tune(key, value)
    assert code == 1 and why in told
    assert stack.robot.fsm.deployment == stack.robot.fsm._original


def test_what_was_changed_is_listed_and_shown_in_the_status(stack, tune):
    tune("wbc.kp", "90")
    code, told = tune("--list", "--json")
    rows = {row["key"]: row for row in json.loads(told)}
    assert code == 0 and [key for key, row in rows.items() if row["changed"]] == ["wbc.kp"]
    assert rows["wbc.kp"] == {
        "key": "wbc.kp",
        "value": 90.0,
        "begun": 100.0,
        "least": 0.0,
        "most": 10000.0,
        "changed": True,
    }
    assert "0 to 10000" in tune("--list")[1]
    watch = StackWatch(stack.join)
    assert watch.table()["tuned"] == ["wbc.kp=90.0"]
    watch.close()


def test_what_was_changed_is_saved_as_a_deployment(stack, tune, tmp_path):
    path = tmp_path / "mine.toml"
    tune("fsm.collapse_m", "0.025")
    code, told = tune("--save", str(path))
    assert code == 0 and "1 settings changed" in told
    assert load_deployment(path).fsm.collapse_m == 0.025
    assert "collapse_m = 0.025  # tuned; the run began with 0.03" in path.read_text()
    code, told = tune("--save", str(path))
    assert code == 2 and "is there already: give another name" in told


def test_a_call_that_says_nothing_whole_is_wrong(tune):
    for words in ((), ("wbc.kp",), ("wbc.kp", "90", "--list")):
        code, told = tune(*words)
        assert code == 2 and "give KEY and VALUE, or --list, or --save FILE" in told


def test_a_remote_tunes(stack):
    session = stack.join()
    remote = Remote(session)
    assert remote.tune("wbc.kp", 95.0).words == "wbc.kp=95.0 from the next step on"
    assert remote.tune("wbc.wrench_weight", (1.0, 1.0, 2.0, 2.0, 2.0, 2.0)).taken
    assert not remote.tune("fsm.cap_forces", 1.0).taken and remote.tune("fsm.cap_forces", True).taken
    remote.close()
    session.close()
