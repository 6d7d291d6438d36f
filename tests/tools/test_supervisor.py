"""Which process may be restarted when, and that a stop is carried through."""

import os
import signal

import pytest

from surefoot.bus.messages import MotionReference
from surefoot.bus.topics import PROCESSES
from surefoot.config.deployment import Deployment, Run
from surefoot.tools.supervisor import Supervisor


@pytest.fixture
def restart(tmp_path, monkeypatch):
    """Asks for a restart while the robot is in a state; what was started and commanded, and what was noted."""

    def ask(name, state=None, clock="monotonic"):
        deployment = Deployment(run=Run(clock=clock, log_dir=str(tmp_path)))
        supervisor, done = Supervisor(tmp_path / "flat.toml", [], deployment), []
        monkeypatch.setattr(supervisor, "_start", done.append)
        monkeypatch.setattr(supervisor, "_command", done.append)
        if state is not None:
            supervisor.picture.reference = MotionReference(state=state)
        supervisor.restart(name)
        return done, supervisor.picture.notes[-1]

    return ask


@pytest.mark.parametrize("name", ["estimator", "wbc", "fsm"])
@pytest.mark.parametrize("state", ["STAND", "PROBE", "SIT_DOWN", None])
def test_in_real_time_what_holds_the_robot_is_not_restarted(restart, name, state):
    done, said = restart(name, state)
    assert done == []
    assert f"cannot restart {name} in state {state or 'unknown'}" in said
    assert "without memory" in said and "`surefoot command sit` first" in said


@pytest.mark.parametrize("name", ["estimator", "wbc", "fsm"])
def test_while_the_robot_is_damped_it_is_and_the_robot_stays_damped(restart, name):
    assert restart(name, "DAMP") == ([name], f"{name} restarted on request")


@pytest.mark.parametrize("name", ["trajopt", "elevation_map", "mpc"])
def test_what_the_robot_can_stand_without_is_restarted_at_any_time(restart, name):
    assert restart(name, "PROBE") == ([name], f"{name} restarted on request")


def test_in_simulation_everything_but_io_is(restart):
    for name in ("estimator", "wbc", "mpc", "fsm"):
        assert restart(name, "PROBE", "simulated") == ([name], f"{name} restarted on request")
    done, said = restart("io", "DAMP")
    assert done == [] and "holds the robot and the bus" in said


def test_a_stop_is_carried_through_whoever_presses_ctrl_c_again(tmp_path, monkeypatch):
    supervisor, ended = Supervisor(tmp_path / "flat.toml", [], Deployment()), []

    def end(watched):
        os.kill(os.getpid(), signal.SIGINT)
        os.kill(os.getpid(), signal.SIGTERM)
        ended.append(watched.name)

    monkeypatch.setattr(supervisor, "_end", end)
    before = signal.getsignal(signal.SIGINT)
    supervisor.stop()
    assert sorted(ended) == sorted(PROCESSES) and ended[-1] == "io"
    assert signal.getsignal(signal.SIGINT) == before
