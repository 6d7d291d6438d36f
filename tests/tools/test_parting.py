"""A run in real time that has lost a process: the robot sits down, then the run ends."""

import pytest

from surefoot.bus.messages import HardwareState, MotionReference
from surefoot.config.deployment import Deployment
from surefoot.config.operator import Operator
from surefoot.tools.parting import Parting
from surefoot.tools.picture import Picture

WHAT = "it ended with signal 9"


class Run:
    """A robot that probes."""

    def __init__(self, settle_s=60.0):
        self.picture = Picture(reference=MotionReference(state="PROBE"), hardware=HardwareState())
        self.commands, self.notes = [], []
        deployment = Deployment(operator=Operator(settle_s=settle_s))
        self.parting = Parting(deployment, self.picture, self.commands.append, self.notes.append)

    def lost(self, name):
        return self.parting.lost(name, WHAT)


@pytest.mark.parametrize("name", ["mpc", "trajopt", "elevation_map"])
def test_the_robot_is_told_once_to_sit_and_the_run_ends_when_it_is_damped(name):
    run = Run()
    assert [run.lost(name) for _ in range(3)] == ["", "", ""]
    assert run.commands == [f"sit: {name} has ended"] and run.notes == [
        f"{WHAT}; the robot sits down before the run ends"
    ]
    run.picture.reference = MotionReference(state="DAMP")
    assert run.lost(name) == WHAT


def test_without_a_state_machine_the_controller_lowers_the_robot_by_itself():
    run = Run()
    assert run.lost("fsm") == "" and run.commands == []
    run.picture.hardware = HardwareState(damping=True)
    assert run.lost("fsm") == WHAT


@pytest.mark.parametrize("name", ["io", "estimator", "wbc"])
def test_what_it_cannot_settle_without_ends_the_run_at_once(name):
    assert Run().lost(name) == WHAT


def test_it_is_not_waited_for_longer_than_it_may_take_and_another_loss_is_not_waited_for():
    assert Run(settle_s=0.0).lost("mpc") == WHAT
    run = Run()
    assert run.lost("mpc") == "" and run.lost("wbc") == WHAT


def test_before_the_robot_has_begun_nothing_is_waited_for():
    run = Run()
    run.picture.hardware = None
    assert run.lost("mpc") == WHAT
