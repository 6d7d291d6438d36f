"""Which process may be restarted when, and that a stop is carried through."""

import os
import signal

import pytest

from surefoot.bus.messages import MotionReference
from surefoot.bus.topics import PROCESSES
from surefoot.config.deployment import Deployment, Run
from surefoot.config.network import Network
from surefoot.tools import supervisor as supervisor_module
from surefoot.tools.supervisor import Supervisor


class Child:
    """In place of a process."""

    code = None

    def poll(self):
        return self.code

    def terminate(self):
        self.code = 0

    def wait(self, timeout=None):
        pass


class Fake(Supervisor):
    """Starts no process; `launched` is what it would have started."""

    def __init__(self, *args):
        super().__init__(*args)
        self.launched = []
        for watched in self.picture.processes.values():
            watched.popen = Child()

    def _launch(self, name, boot, *words):
        self.launched.append((name, boot, *words))
        return Child()

    @property
    def notes(self):
        return self.picture.notes


@pytest.fixture
def restart(tmp_path):
    """Asks for a restart while the robot is in a state; the supervisor."""

    def ask(name, state=None, clock="monotonic"):
        deployment = Deployment(run=Run(clock=clock, log_dir=str(tmp_path)))
        supervisor = Fake(tmp_path / "flat.toml", [], deployment)
        if state is not None:
            supervisor.picture.reference = MotionReference(state=state)
        supervisor.restart(name)
        return supervisor

    return ask


@pytest.mark.parametrize("name", ["estimator", "wbc", "fsm"])
@pytest.mark.parametrize("state", ["DETECT_CONTACT", "PROBE", "SIT_DOWN", None])
def test_in_real_time_what_holds_the_robot_is_not_restarted_while_it_moves(restart, name, state):
    supervisor = restart(name, state)
    assert supervisor.launched == []
    assert f"cannot restart {name} in state {state or 'unknown'}" in supervisor.notes[-1]
    assert "`surefoot command stop` or sit first" in supervisor.notes[-1]


@pytest.mark.parametrize(
    ("name", "state"), [("fsm", "STAND"), ("wbc", "STOPPED"), ("estimator", "DAMP"), ("mpc", "PROBE")]
)
def test_in_real_time_a_successor_is_ready_before_its_predecessor_leaves(restart, name, state):
    supervisor = restart(name, state)
    watched = supervisor.picture.processes[name]
    before = watched.popen
    assert supervisor.launched == [(name, 1, "--relieve")]
    supervisor.restart(name)
    assert supervisor.notes == [f"{name} is being restarted already"] and len(supervisor.launched) == 1
    assert supervisor._reconcile() == "" and watched.popen is before and before.code is None
    before.code = 0  # it has left its place
    assert supervisor._reconcile() == "" and watched.popen is not before and watched.restarts == 1
    assert supervisor.notes[-1] == f"{name} restarted on request"
    watched.popen.code = 1
    assert f"{name} ended with exit code 1" in supervisor._reconcile()


def test_a_process_goes_on_if_its_successor_fails(restart):
    supervisor = restart("wbc", "STAND")
    supervisor._successors["wbc"].code = 1
    watched = supervisor.picture.processes["wbc"]
    assert supervisor._reconcile() == "" and watched.exit_code is None and watched.restarts == 0
    assert "wbc goes on as it was: its successor failed; wbc ended with exit code 1" in supervisor.notes[-1]


@pytest.mark.parametrize(("name", "state"), [("mpc", "PROBE"), ("wbc", "DAMP")])
def test_what_the_robot_can_be_without_is_then_started_anew(restart, name, state):
    supervisor = restart(name, state)
    before = supervisor.picture.processes[name].popen
    supervisor._successors[name].code = 1
    assert supervisor._reconcile() == "" and before.code == 0
    assert supervisor.launched[1:] == [(name, 1)]
    assert f"{name} restarted on request, without its memory" in supervisor.notes[-1]


def test_a_stop_ends_a_successor_too(restart):
    supervisor = restart("mpc", "STAND")
    supervisor.stop()
    assert supervisor._successors["mpc"].code == 0


def test_in_simulation_everything_but_io_is(restart):
    for name in ("estimator", "wbc", "mpc", "fsm"):
        supervisor = restart(name, "PROBE", "simulated")
        assert supervisor.launched == [(name, 1)] and supervisor.notes == [f"{name} restarted on request"]
    supervisor = restart("io", "DAMP")
    assert supervisor.launched == [] and "holds the robot and the bus" in supervisor.notes[-1]


def test_a_stop_is_carried_through_whoever_presses_ctrl_c_again(tmp_path, monkeypatch):
    supervisor, ended = Supervisor(tmp_path / "flat.toml", [], Deployment()), []

    names = {}
    for watched in supervisor.picture.processes.values():
        watched.popen = Child()
        names[watched.popen] = watched.name

    def end(popen):
        os.kill(os.getpid(), signal.SIGINT)
        os.kill(os.getpid(), signal.SIGTERM)
        ended.append(names[popen])

    monkeypatch.setattr("surefoot.tools.supervisor._end", end)
    before = signal.getsignal(signal.SIGINT)
    supervisor.stop()
    assert sorted(ended) == sorted(PROCESSES) and ended[-1] == "io"
    assert signal.getsignal(signal.SIGINT) == before


HOSTS = {"robot": ("io", "estimator", "wbc", "fsm"), "laptop": ("mpc", "trajopt", "elevation_map")}


class Bus:
    """In place of the session."""

    def __init__(self, *args, **kwargs):
        self.said = []

    def newest(self, key):
        return lambda: None

    def subscribe(self, key, receive):
        pass

    def put(self, key, payload):
        self.said.append((key, payload))

    def close(self):
        pass


@pytest.mark.parametrize("clock", ["simulated", "monotonic"])
@pytest.mark.parametrize("host", ["robot", "laptop"])
def test_each_machine_starts_its_own_processes_and_that_of_io_gives_the_command(
    tmp_path, monkeypatch, host, clock
):
    network = Network(hosts=HOSTS, listen="tls/0.0.0.0:7448", address="10.0.0.1", host=host)
    run = Run(clock=clock, log_dir=str(tmp_path), namespace="nobody", command="stand")
    supervisor = Supervisor(tmp_path / "flat.toml", [], Deployment(run=run, network=network))
    started, bus = [], Bus()
    monkeypatch.setattr(supervisor_module, "check_keys", lambda network: None)
    monkeypatch.setattr(supervisor, "_start", started.append)
    monkeypatch.setattr(supervisor, "_connect", lambda: bus)
    monkeypatch.setattr(supervisor, "_await", lambda name, *rest: None)
    assert supervisor.run(lambda picture: "enough") == "enough"
    assert started == list(HOSTS[host])
    assert [payload for _, payload in bus.said] == ([b"stand"] if host == "robot" else [])
    away = {name: watched.host for name, watched in supervisor.picture.processes.items() if watched.host}
    assert away == {name: other for other in HOSTS if other != host for name in HOSTS[other]}
    supervisor.restart(next(iter(away)))
    assert "for the supervisor of" in supervisor.picture.notes[-1] and started == list(HOSTS[host])
