"""A run that is to end or has lost a process: the robot sits down first where nobody else holds it."""

import pytest

from surefoot.bus.messages import HardwareState, MotionReference
from surefoot.config.aliengo import Aliengo
from surefoot.config.deployment import Deployment, Run
from surefoot.config.hw import Hw
from surefoot.config.operator import Operator
from surefoot.tools.parting import Parting
from surefoot.tools.picture import Picture

WHAT = "it ended with signal 9"


class Probing:
    """A robot that probes."""

    def __init__(self, settle_s=60.0, clock="monotonic", backend="mujoco", speed=1.0):
        self.picture = Picture(reference=MotionReference(state="PROBE"), hardware=HardwareState())
        self.commands, self.notes = [], []
        wire = Aliengo(address="127.0.0.1", exchange="cycle" if backend == "aliengo" else "timer")
        hw, operator = Hw(backend=backend, aliengo=wire), Operator(settle_s=settle_s)
        deployment = Deployment(run=Run(clock=clock, speed=speed), hw=hw, operator=operator)
        self.parting = Parting(deployment, self.picture, self.commands.append, self.notes.append)

    def lost(self, name):
        return self.parting.lost(name, WHAT)


@pytest.mark.parametrize("name", ["mpc", "trajopt", "elevation_map"])
def test_the_robot_is_told_once_to_sit_and_the_run_ends_when_it_is_damped(name):
    run = Probing()
    assert [run.lost(name) for _ in range(3)] == ["", "", ""]
    assert run.commands == [f"sit: {name} has ended"] and run.notes == [
        f"{WHAT}; the robot sits down before the run ends"
    ]
    run.picture.reference = MotionReference(state="DAMP")
    assert run.lost(name) == WHAT


def test_without_a_state_machine_the_controller_lowers_the_robot_by_itself():
    run = Probing()
    assert run.lost("fsm") == "" and run.commands == []
    run.picture.hardware = HardwareState(damping=True)
    assert run.lost("fsm") == WHAT


@pytest.mark.parametrize("name", ["io", "estimator", "wbc"])
def test_what_it_cannot_settle_without_ends_the_run_at_once(name):
    assert Probing().lost(name) == WHAT


def test_it_is_not_waited_for_longer_than_it_may_take_and_another_loss_is_not_waited_for():
    assert Probing(settle_s=0.0).lost("mpc") == WHAT
    run = Probing()
    assert run.lost("mpc") == "" and run.lost("wbc") == WHAT


def test_before_the_robot_has_begun_nothing_is_waited_for():
    run = Probing()
    run.picture.hardware = None
    assert run.lost("mpc") == WHAT and run.parting.end("time is up") == "time is up"


@pytest.mark.parametrize(("clock", "backend"), [("monotonic", "mujoco"), ("simulated", "aliengo")])
def test_a_run_that_is_to_end_has_the_robot_sit_down_once_and_ends_for_its_first_reason(clock, backend):
    run = Probing(clock=clock, backend=backend)
    assert run.parting.end("") == "" and run.commands == [] and run.parting.settles
    assert [run.parting.end(why) for why in ("goal reached", "", "ended by the user")] == ["", "", ""]
    assert run.commands == ["sit: the run is to end"] and len(run.notes) == 1 and not run.parting.settles
    run.picture.reference = MotionReference(state="DAMP")
    assert run.parting.end("") == "goal reached" and not run.parting.settles


def test_where_time_is_simulated_the_robot_has_its_seconds_of_that():
    run = Probing(clock="simulated", backend="aliengo", settle_s=2.0)
    assert run.parting.end("goal reached") == ""
    run.picture.reference = MotionReference(state="PROBE", t=1.9)
    assert run.parting.end("") == ""
    run.picture.reference = MotionReference(state="PROBE", t=2.1)
    assert run.parting.end("") == "goal reached"


def test_a_process_that_is_lost_meanwhile_changes_nothing_if_the_robot_can_sit_without_it():
    run = Probing()
    assert run.parting.end("goal reached") == "" and run.lost("mpc") == "" and len(run.commands) == 1
    assert run.lost("wbc") == WHAT


def test_a_simulated_robot_on_simulated_time_is_not_waited_for():
    run = Probing(clock="simulated")
    assert run.parting.end("goal reached") == "goal reached" and run.commands == [] and not run.parting.settles


def test_where_time_goes_slower_the_robot_is_waited_for_longer(monkeypatch):
    now = 100.0
    monkeypatch.setattr("surefoot.tools.parting.time.monotonic", lambda: now)
    run = Probing(settle_s=2.0, speed=0.25)
    assert run.lost("mpc") == ""
    now += 7.9
    assert run.lost("mpc") == ""
    now += 0.2
    assert run.lost("mpc") == WHAT
