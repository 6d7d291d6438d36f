"""Which process may be restarted or lent when, and that a stop is carried through."""

import json
import os
import signal
import subprocess
import sys
from dataclasses import replace

import pytest

from surefoot.bus.errors import BusError
from surefoot.bus.messages import HardwareState, MotionReference, ProcessStatus
from surefoot.bus.topics import PROCESSES
from surefoot.components import clock_messages as clock
from surefoot.config.deployment import Deployment, Run
from surefoot.config.hw import Hw
from surefoot.config.network import Network
from surefoot.config.typed_toml import to_table
from surefoot.tools import end_signals, launcher, lending, supervisor_desk
from surefoot.tools import supervisor as supervisor_module
from surefoot.tools.reload.source_watch import SourceWatch
from surefoot.tools.supervisor import ENDED_BY_USER, Supervisor
from surefoot.tools.supervisor_messages import Answer


class Child:
    """In place of a process."""

    code = None

    def poll(self):
        return self.code

    def terminate(self):
        self.code = 0

    def send_signal(self, number):
        pass

    def wait(self, timeout=None):
        pass


class Fake(Supervisor):
    """Starts no process; `launched` is what it would have started, `commands` what the robot was told."""

    def __init__(self, *args):
        super().__init__(*args)
        self.launched, self.commands = [], []
        self._launcher.launch = self._launch
        for watched in self.picture.processes.values():
            watched.popen = Child()

    def _launch(self, name, boot, *words):
        self.launched.append((name, boot, *words))
        return Child()

    def command(self, command):
        self.commands.append(command)

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
    assert (
        supervisor.notes == [f"cannot restart {name}: it is being restarted already"]
        and len(supervisor.launched) == 1
    )
    assert supervisor._reconcile() == "" and watched.popen is before and before.code is None
    before.code = 0  # it has left its place
    assert supervisor._reconcile() == "" and watched.popen is not before and watched.restarts == 1
    assert supervisor.notes[-1] == f"{name} restarted on request"
    watched.popen.code = 1
    assert f"{name} ended with exit code 1" in (supervisor._reconcile() or supervisor.notes[-1])


def test_in_real_time_a_process_that_ends_lets_the_robot_sit_down_first(restart):
    supervisor = restart("trajopt", "STAND")
    supervisor.picture.hardware = HardwareState()
    supervisor.picture.processes["mpc"].popen.code = -9
    assert supervisor._reconcile() == "" and supervisor._reconcile() == ""
    assert supervisor.commands == ["sit: mpc has ended"] and "mpc ended with signal 9" in supervisor.notes[-1]
    supervisor.picture.reference = MotionReference(state="DAMP")
    assert "mpc ended with signal 9" in supervisor._reconcile()


def test_a_process_goes_on_if_its_successor_fails(restart):
    supervisor = restart("wbc", "STAND")
    supervisor._handovers._successors["wbc"].code = 1
    watched = supervisor.picture.processes["wbc"]
    assert supervisor._reconcile() == "" and watched.exit_code is None and watched.restarts == 0
    assert "wbc goes on as it was: its successor failed; wbc ended with exit code 1" in supervisor.notes[-1]


@pytest.mark.parametrize(("name", "state"), [("mpc", "PROBE"), ("wbc", "DAMP")])
def test_what_the_robot_can_be_without_is_then_started_anew(restart, name, state):
    supervisor = restart(name, state)
    before = supervisor.picture.processes[name].popen
    supervisor._handovers._successors[name].code = 1
    assert supervisor._reconcile() == "" and before.code == 0
    assert supervisor.launched[1:] == [(name, 1)]
    assert f"{name} restarted on request, without its memory" in supervisor.notes[-1]


def test_a_stop_ends_a_successor_too(restart):
    supervisor = restart("mpc", "STAND")
    supervisor.stop()
    assert supervisor._handovers._successors["mpc"].code == 0


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
        os.kill(os.getpid(), signal.SIGHUP)
        ended.append(names[popen])

    monkeypatch.setattr(supervisor_module, "end_process", end)
    before = signal.getsignal(signal.SIGINT)
    supervisor.stop()
    assert sorted(ended) == sorted(PROCESSES) and ended[-1] == "io"
    assert signal.getsignal(signal.SIGINT) == before


@pytest.fixture
def sleeper():
    """Starts real processes that sleep after some code."""
    made = []

    def start(code="pass"):
        code = f"import os, signal, time; {code}; print(flush=True); time.sleep(600)"
        made.append(subprocess.Popen([sys.executable, "-c", code], stdout=subprocess.PIPE))
        made[-1].stdout.readline()
        return made[-1]

    yield start
    for each in made:
        each.kill()
        each.wait()


def test_one_that_is_stopped_still_ends_in_order(tmp_path, sleeper):
    supervisor = Supervisor(tmp_path / "flat.toml", [], Deployment())
    mpc = supervisor.picture.processes["mpc"]
    mpc.popen = sleeper("signal.signal(signal.SIGTERM, lambda *_: os._exit(7))")
    mpc.popen.send_signal(signal.SIGSTOP)
    supervisor.stop()
    assert mpc.popen.returncode == 7


def test_one_that_hangs_is_killed_in_its_time(tmp_path, sleeper, monkeypatch):
    monkeypatch.setattr(launcher, "KILL_AFTER_S", 0.2)
    supervisor = Supervisor(tmp_path / "flat.toml", [], Deployment())
    for name in ("mpc", "io"):
        supervisor.picture.processes[name].popen = sleeper("signal.signal(signal.SIGTERM, signal.SIG_IGN)")
    supervisor.stop()
    assert all(supervisor.picture.processes[name].popen.returncode == -signal.SIGKILL for name in ("mpc", "io"))


class Desk:
    """A supervisor that starts nothing; what it would have started and answered."""

    def __init__(self, tmp_path, clock="simulated", sources=None):
        deployment = Deployment(run=Run(clock=clock, log_dir=str(tmp_path)))
        self.supervisor = Supervisor(tmp_path / "flat.toml", [], deployment, sources)
        self.done, self.answers = [], []
        self.supervisor._start = lambda watched: self.done.append(watched.name)
        self.supervisor._lending._answer = lambda pid, answer: self.answers.append((pid, answer))
        self.picture = self.supervisor.picture

    def ask(self, *requests):
        for request in requests:
            self.supervisor._desk.ask(request)
        return self.supervisor._reconcile()

    @property
    def said(self):
        return self.picture.notes[-1]


def test_a_process_is_lent_taken_back_and_neither_restarted_nor_lent_twice_meanwhile(tmp_path, sleeper):
    desk, borrower = Desk(tmp_path), sleeper()
    wbc = desk.picture.processes["wbc"]
    wbc.popen = own = sleeper()
    desk.ask(f"lend wbc {borrower.pid}")
    assert own.poll() is not None  # ended before the other begins
    assert desk.answers == [(borrower.pid, Answer(1))] and desk.done == []
    assert wbc.lent_to == borrower.pid and wbc.exit_code is None
    assert f"wbc lent to process {borrower.pid}" in desk.said
    desk.ask("restart wbc")
    assert desk.said == f"cannot restart wbc: it is lent to process {borrower.pid}; end that one"
    other = sleeper()
    desk.ask(f"lend wbc {other.pid}")
    assert desk.answers[-1][0] == other.pid and desk.answers[-1][1].boot == -1
    assert "does not lend wbc: it is lent to process" in desk.answers[-1][1].words
    assert desk.done == [] and wbc.restarts == 1
    borrower.kill()
    borrower.wait()
    desk.ask()
    assert desk.done == ["wbc"] and wbc.lent_to == 0 and wbc.restarts == 2
    assert desk.said == f"process {borrower.pid} has ended: wbc is started again here"


def test_io_and_in_real_time_what_holds_the_robot_are_not_lent(tmp_path, sleeper):
    desk, borrower = Desk(tmp_path, "monotonic"), sleeper()
    refused = (("io", "holds the robot and the bus"), ("wbc", "in real time nothing waits"), ("x", "there are"))
    for name, words in refused:
        desk.ask(f"lend {name} {borrower.pid}")
        assert desk.answers[-1][1].boot == -1 and words in desk.answers[-1][1].words
    desk.picture.reference = MotionReference(state="DAMP")
    desk.ask(f"lend wbc {borrower.pid}")
    assert desk.answers[-1] == (borrower.pid, Answer(1))
    # One who ends it while the robot moves ends the run, as a crash would.
    desk.picture.reference = MotionReference(state="PROBE")
    borrower.kill()
    borrower.wait()
    said = desk.ask()
    assert said.startswith(
        f"process {borrower.pid}, which had wbc, has ended in state PROBE: in real time nothing"
    )
    assert desk.done == []


def test_a_lent_process_is_told_to_end_with_the_run_and_not_killed(tmp_path, sleeper, monkeypatch):
    monkeypatch.setattr(lending, "KILL_AFTER_S", 0.2)
    desk = Desk(tmp_path)
    good, at_a_prompt = sleeper(), sleeper("signal.signal(signal.SIGTERM, signal.SIG_IGN)")
    desk.ask(f"lend wbc {good.pid}", f"lend mpc {at_a_prompt.pid}")
    desk.supervisor.stop()
    assert good.wait() == -signal.SIGTERM and at_a_prompt.poll() is None


@pytest.mark.parametrize("request_", ["", "lend wbc", "lend wbc me", "restart", "restart a b", "dance"])
def test_what_is_no_request_is_said_and_changes_nothing(tmp_path, request_):
    desk = Desk(tmp_path)
    assert desk.ask(request_) == "" and "not understood" in desk.said
    assert desk.done == [] and desk.answers == []


def test_to_lend_to_a_process_that_is_not_there_changes_nothing(tmp_path, sleeper):
    desk, gone = Desk(tmp_path), sleeper()
    gone.kill()
    gone.wait()
    desk.ask(f"lend wbc {gone.pid}")
    assert "there is none" in desk.said and desk.done == []


def test_a_storm_of_requests_ends_and_what_crashes_meanwhile_is_started_too(tmp_path, sleeper):
    desk = Desk(tmp_path)
    estimator = desk.picture.processes["estimator"]
    estimator.popen = sleeper()
    estimator.popen.kill()
    estimator.popen.wait()
    assert desk.ask(*["restart wbc", "restart mpc", "restart wbc"] * 20) == ""
    assert desk.done == ["estimator", "wbc"]
    estimator.popen = None
    desk.picture.note_status(ProcessStatus(process="wbc", boot=1, nominal_hz=250.0, steps=1))
    desk.ask("stop", "restart fsm")
    assert desk.supervisor._asked == "stopped by command"
    assert desk.done == ["estimator", "wbc", "mpc"]
    assert len(desk.picture.notes) == 3  # the crash and two restarts


def test_with_reload_one_that_fails_waits_for_its_source_and_one_that_is_killed_does_not(tmp_path, sleeper):
    (tmp_path / "components").mkdir()
    desk = Desk(tmp_path, sources=SourceWatch(tmp_path))
    mpc = desk.picture.processes["mpc"]
    mpc.popen = subprocess.Popen([sys.executable, "-c", "raise SystemExit(1)"])
    mpc.popen.wait()
    assert desk.ask() == "" and desk.done == []
    assert "ended with exit code 1" in mpc.out and "waits for its source to change" in desk.said
    desk.ask("restart mpc")
    assert desk.done == ["mpc"]
    mpc.out, mpc.popen = "", sleeper()
    mpc.popen.kill()
    mpc.popen.wait()
    desk.ask()
    assert desk.done == ["mpc", "mpc"] and "restarted, 1 of 3" in desk.said


HOSTS = {"robot": ("io", "estimator", "wbc", "fsm"), "laptop": ("mpc", "trajopt", "elevation_map")}


class Bus:
    """In place of the session, to an io that runs a deployment."""

    def __init__(self, deployment):
        self.said, self._deployment = [], deployment

    def ask(self, key):
        return [json.dumps(to_table(self._deployment)).encode()]

    def newest(self, key):
        return lambda: None

    def subscribe(self, key, receive):
        pass

    def put(self, key, payload, lossless=True):
        if key == clock.REQUEST:
            self.said.append((key, payload))

    def serve(self, key, answer):
        pass

    def close(self):
        pass


@pytest.fixture
def machine(tmp_path, monkeypatch):
    """Makes the supervisor of a machine; what it starts, and its bus."""

    def make(host, clock="simulated", seed_of_io=0):
        network = Network(hosts=HOSTS, listen="tls/0.0.0.0:7448", address="10.0.0.1", host=host)
        run = Run(clock=clock, log_dir=str(tmp_path), namespace="nobody", command="stand")
        deployment = Deployment(run=run, network=network)
        (tmp_path / "flat.toml").touch()
        supervisor = Supervisor(tmp_path / "flat.toml", [], deployment)
        started, bus = [], Bus(replace(deployment, hw=Hw(seed=seed_of_io)))
        monkeypatch.setattr(supervisor_module, "check_keys", lambda network: None)
        monkeypatch.setattr(supervisor, "_start", lambda watched: started.append(watched.name))
        monkeypatch.setattr(supervisor_desk, "Session", lambda *args, **kwargs: bus)
        monkeypatch.setattr(supervisor, "_await_io", lambda each: None)
        for name, watched in supervisor.picture.processes.items():
            watched.status = ProcessStatus(process=name)
        return supervisor, started, bus

    return make


def test_a_machine_with_other_settings_than_ios_starts_nothing(machine):
    supervisor, started, _ = machine("laptop", seed_of_io=3)
    with pytest.raises(
        BusError, match=r"laptop has other settings than io: hw\.seed = 0, not 3; give every machine"
    ):
        supervisor.run(lambda picture: "enough")
    assert started == []


@pytest.mark.parametrize("late", ["fsm", "wbc", "mpc"])
def test_in_real_time_the_first_command_waits_for_every_process(machine, late):
    supervisor, _, bus = machine("robot", "monotonic")
    process, looks = supervisor.picture.processes[late], iter(range(4))
    process.status = None

    def until(picture):
        if next(looks) == 2:
            assert bus.said == []
            process.status = ProcessStatus(process=late)
        return "enough" if bus.said else ""

    assert supervisor.run(until) == "enough"
    assert [payload for _, payload in bus.said] == [b"stand"]


def test_a_robot_that_stands_on_its_own_time_sits_down_before_the_run_ends(machine):
    supervisor, _, bus = machine("robot", "monotonic")
    supervisor.picture.hardware = HardwareState()
    supervisor.picture.reference = MotionReference(state="PROBE")

    def look(picture):
        if len(bus.said) == 2:
            picture.reference = MotionReference(state="DAMP")

    assert supervisor.run(lambda picture: "enough", look) == "enough"
    assert [payload for _, payload in bus.said] == [b"stand", b"sit: the run is to end"]


@pytest.fixture
def handlers():
    """Puts back what is done about each signal."""
    before = {number: signal.getsignal(number) for number in end_signals.ENDS_RUN}
    yield
    for number, handler in before.items():
        signal.signal(number, handler)


def test_a_signal_ends_a_run_at_its_next_look_if_it_is_the_second_or_there_is_nothing_to_wait_for(
    machine, handlers
):
    supervisor, _, bus = machine("robot", "monotonic")
    end_signals.heed(supervisor.end)
    with pytest.raises(KeyboardInterrupt):  # it has not begun to look
        os.kill(os.getpid(), signal.SIGTERM)
    looks = []

    def look(picture):
        looks.append(picture.t)
        if signals:
            os.kill(os.getpid(), signals.pop())  # no exception, whatever it is at
            looks.append("goes on")

    signals = [signal.SIGTERM]
    assert supervisor.run(lambda picture: "", look) == ENDED_BY_USER
    assert looks[-1] == "goes on" and looks.count("goes on") == 1 and [each for _, each in bus.said] == [b"stand"]

    supervisor, _, bus = machine("robot", "monotonic")
    end_signals.heed(supervisor.end)
    supervisor.picture.hardware = HardwareState()
    supervisor.picture.reference = MotionReference(state="PROBE")
    signals = [signal.SIGINT, signal.SIGTERM]
    assert supervisor.run(lambda picture: "", look) == ENDED_BY_USER
    assert [payload for _, payload in bus.said] == [b"stand", b"sit: the run is to end"]


def test_a_run_that_hangs_is_broken_off_by_one_signal_more(machine, handlers):
    supervisor, _, _ = machine("robot", "monotonic")
    end_signals.heed(supervisor.end)

    def hangs(picture):
        os.kill(os.getpid(), signal.SIGTERM)
        os.kill(os.getpid(), signal.SIGINT)

    with pytest.raises(KeyboardInterrupt):
        supervisor.run(lambda picture: "", hangs)


@pytest.mark.parametrize("clock", ["simulated", "monotonic"])
@pytest.mark.parametrize("host", ["robot", "laptop"])
def test_each_machine_starts_its_own_processes_and_that_of_io_gives_the_command(machine, host, clock):
    supervisor, started, bus = machine(host, clock)
    assert supervisor.run(lambda picture: "enough") == "enough"
    assert started == list(HOSTS[host])
    assert [payload for _, payload in bus.said] == ([b"stand"] if host == "robot" else [])
    away = {name: watched.host for name, watched in supervisor.picture.processes.items() if watched.host}
    assert away == {name: other for other in HOSTS if other != host for name in HOSTS[other]}
    supervisor.restart(next(iter(away)))
    assert "for the supervisor of" in supervisor.picture.notes[-1] and started == list(HOSTS[host])
