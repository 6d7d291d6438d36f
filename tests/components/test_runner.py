"""A process on the monotonic clock lets go of the robot before it leaves, unless another takes its place."""

import json
from dataclasses import astuple, replace

import msgpack
import numpy as np
import pytest

from surefoot.bus.codec import decode
from surefoot.bus.errors import BusError
from surefoot.bus.messages import FsmEvent, JointCommand, ProcessStatus
from surefoot.bus.session import Marked
from surefoot.components import clock_messages as clock
from surefoot.components import runner
from surefoot.components.clock_messages import pack_snapshot
from surefoot.components.component import Component
from surefoot.components.memory import ForeignMemory, Memory
from surefoot.components.relief import Place
from surefoot.components.run_clock import AnotherRun
from surefoot.components.wbc.wbc import Wbc
from surefoot.config.deployment import Deployment, Run
from surefoot.config.hw import Hw
from surefoot.config.network import COMPONENTS, Network
from surefoot.config.shared_settings import settings_digest
from surefoot.config.typed_toml import to_table


class Bus:
    """In place of the session: keeps what is published; asks and answers as a successor and a predecessor.

    Attributes:
        asks: what a successor asks as soon as it is listened for.
        place: where the predecessor stands, if there is one.
        deployment: what io says it runs.
    """

    asks, place, deployment, damaged = (), None, None, 0

    def __init__(self, *args, **kwargs):
        self.sent, self.open, self.heard = [], True, {}

    def put(self, key, payload, lossless=True):
        assert self.open
        self.sent.append((key, payload))
        if key.startswith("relief/ask/") and self.place is not None:
            self.heard[key.replace("ask", "answer")]("", msgpack.packb(astuple(self.place)))

    def newest(self, key):
        return lambda: None

    def subscribe(self, key, receive):
        self.heard[key] = receive
        for word in self.asks if key.startswith("relief/ask/") else ():
            receive(key, word)

    def ask(self, key):
        return [json.dumps(to_table(self.deployment)).encode()]

    def serve_each(self, key, answer):
        pass

    def close(self):
        self.open = False

    def statuses(self):
        return [decode(ProcessStatus, payload) for key, payload in self.sent if key.startswith("status/")]

    def lives(self):
        return [status.life for status in self.statuses()]


class Told:
    """In place of the signals: told to end after some looks."""

    looks = 3

    def __init__(self, parent):
        self.left = self.looks

    @property
    def due(self):
        self.left -= 1
        return self.left < 0


class Ramp(Component):
    """Needs three releases to let go."""

    name = "fsm"
    memory = Memory("steps")
    needs, broken = 3, False

    def __init__(self, deployment):
        super().__init__(deployment)
        self.steps = self.ramped = 0

    def step(self, t, inbox, outbox):
        self.steps += 1
        if self.broken:
            raise ZeroDivisionError("a step fails")

    def deactivate(self, t, inbox, outbox):
        self.ramped += 1
        return self.ramped == self.needs


class Stubborn(Ramp):
    needs = 0


class Broken(Ramp):
    broken = True


@pytest.fixture
def process(monkeypatch):
    """Makes a runner of a component on the monotonic clock, which ends after three steps."""
    monkeypatch.setattr(runner, "Session", Bus)
    monkeypatch.setattr(runner, "ProcessEnd", Told)
    monkeypatch.setattr("surefoot.components.health._PERIOD_S", 0.0)
    monkeypatch.setattr(runner, "claim", lambda priority, core: False)  # it would be this process's, to its end

    def make(kind, relieves=False, which="monotonic", network=None, boot=0, **bus):
        monkeypatch.setattr(runner, "component_class", lambda name: kind)
        deployment = Deployment(run=Run(clock=which), network=network or Network())
        made = runner.Runner(deployment, kind.name, boot, relieves=relieves)
        vars(made._session).update(bus)
        return made

    return make


def test_it_is_deactivated_until_it_has_let_go(process):
    fsm = process(Ramp)
    assert fsm.run() == 0
    component, bus = fsm._stepper.component, fsm._session
    assert component.steps == 3 and component.ramped == 3 and not bus.open
    assert bus.lives()[-4:] == ["RUN", "DEACTIVATING", "DEACTIVATING", "IDLE"]


def test_one_that_never_lets_go_is_left_after_a_second(process, monkeypatch):
    monkeypatch.setattr(runner, "_LET_GO_S", 0.1)
    fsm = process(Stubborn)
    assert fsm.run() == 0
    assert fsm._stepper.component.ramped == 25


def test_after_a_failed_step_too(process):
    fsm = process(Broken)
    with pytest.raises(ZeroDivisionError):
        fsm.run()
    assert fsm._stepper.component.ramped == 3 and not fsm._session.open
    assert set(fsm._session.lives()[-3:]) == {"FAILED"}


class PassingTime:
    """In place of `time`: a clock that goes on by sleeping; one sleep takes a second too long."""

    def __init__(self, held_up_in):
        self.now, self.slept, self.held_up_in = 1000.0, [], held_up_in

    def monotonic(self):
        return self.now

    def sleep(self, seconds):
        self.slept.append(seconds)
        self.now += seconds + 1.002 * (len(self.slept) == self.held_up_in)


@pytest.mark.parametrize(("hub", "waits_s", "missed"), [(False, runner._CATCH_UP_S, 254), (True, 0.0, 250)])
def test_a_timer_that_was_held_up_lets_its_inputs_come_before_it_reads(hub, waits_s, missed, process, monkeypatch):
    fsm, passing = process(Ramp), PassingTime(held_up_in=2)
    fsm.hub = hub
    monkeypatch.setattr(runner, "time", passing)
    stepped = []
    monkeypatch.setattr(fsm, "_live_step", lambda: stepped.append(passing.now))
    fsm._follow_timer()
    np.testing.assert_allclose(np.diff(stepped), [0.004 + 1.002 + waits_s, 0.0 if waits_s else 0.002], atol=1e-9)
    assert fsm._stepper.health.overruns == missed


def test_the_last_command_of_the_whole_body_controller_brakes(process):
    wbc = process(Wbc)
    wbc.run()
    last = decode(JointCommand, next(payload for key, payload in wbc._session.sent if key == "joint/command"))
    assert last.valid and not last.kp.any() and not last.tau.any()
    np.testing.assert_array_equal(last.kd, Deployment().hw.damping_kd)


def answers(bus):
    return [Place(*msgpack.unpackb(payload)) for key, payload in bus.sent if key == "relief/answer/fsm"]


def test_its_place_is_shown_and_it_goes_on(process):
    fsm = process(Ramp, asks=[b"show"])
    fsm.run()
    assert len(answers(fsm._session)) == 1 and fsm._stepper.component.steps == 3
    assert fsm._stepper.component.ramped == 3


def test_its_place_is_given_and_it_leaves_the_robot_as_it_is(process):
    fsm = process(Ramp, asks=[b"show", b"give"])
    assert fsm.run() == 0
    component, bus = fsm._stepper.component, fsm._session
    assert component.steps == 1 and component.ramped == 0 and not bus.open
    assert [place.snapshot for place in answers(bus)] == [pack_snapshot({"steps": 1})] * 2


def place(state, t=None):
    return Place(t, 7, {}, {}, {}, pack_snapshot(state))


def test_a_successor_goes_on_from_the_place_it_is_given(process):
    fsm = process(Ramp, relieves=True, place=place({"steps": 40}, 1e9))
    fsm.run()
    assert fsm._stepper.component.steps == 43 and fsm._stepper.outbox.boot == 7


def test_a_successor_tells_its_own_restarts_also_where_its_messages_go_on_as_its_predecessors(process):
    fsm = process(Ramp, relieves=True, boot=8, place=place({"steps": 40}, 1e9), asks=[b"show"])
    fsm.run()
    assert {status.boot for status in fsm._session.statuses()} == {8}
    assert fsm._stepper.outbox.boot == 7 and {each.boot for each in answers(fsm._session)} == {7}


def test_a_successor_that_cannot_take_over_asks_for_no_place(process):
    fsm = process(Ramp, relieves=True, place=place({"strides": 40}, 1e9))
    with pytest.raises(ForeignMemory, match="a memory of Ramp holds steps, not strides"):
        fsm.run()
    assert [payload for key, payload in fsm._session.sent if key == "relief/ask/fsm"] == [b"show"]
    assert fsm._stepper.component.steps == fsm._stepper.component.ramped == 0 and not fsm._session.open


def test_a_successor_without_a_predecessor_gives_up(process, monkeypatch):
    monkeypatch.setattr("surefoot.components.relief._PATIENCE_S", 0.01)
    fsm = process(Ramp, relieves=True)
    with pytest.raises(BusError, match="fsm has not answered its successor"):
        fsm.run()
    assert fsm._stepper.component.ramped == 0


HOSTS = {"robot": COMPONENTS[:3], "laptop": COMPONENTS[3:]}
LAPTOP = Network(hosts=HOSTS, listen="tls/0.0.0.0:7448", address="10.0.0.1", host="laptop")
ROBOT = Deployment(run=Run(clock="monotonic"), network=replace(LAPTOP, host="", keys_dir="elsewhere"))


def test_one_on_another_machine_joins_with_the_settings_of_io_and_tells_them_by_a_digest(process, monkeypatch):
    monkeypatch.setattr(runner, "run_clock", lambda *args: lambda: 1.0)
    fsm = process(Ramp, network=LAPTOP, deployment=ROBOT)
    assert fsm.run() == 0 and fsm._stepper.component.steps == 3
    told = [decode(ProcessStatus, payload) for key, payload in fsm._session.sent if key == "status/fsm"]
    assert {status.settings for status in told} == {settings_digest(ROBOT)}


def test_with_others_it_does_nothing_and_names_them(process, monkeypatch):
    monkeypatch.setattr(runner, "run_clock", lambda *args: lambda: 1.0)
    fsm = process(Ramp, network=LAPTOP, deployment=replace(ROBOT, hw=Hw(seed=3)))
    with pytest.raises(BusError, match=r"fsm has other settings than io: hw\.seed = 0, not 3; give every machine"):
        fsm.run()
    assert fsm._stepper.component.steps == 0 and fsm._session.sent == []


class Counter(Component):
    """Publishes the number of its steps."""

    name = "fsm"
    outputs = ("fsm/event",)

    def __init__(self, deployment):
        super().__init__(deployment)
        self.steps = 0

    memory = Memory("steps")

    def step(self, t, inbox, outbox):
        self.steps += 1
        outbox.publish("fsm/event", FsmEvent(t=t, valid=True, reason=str(self.steps)))


class Clock(Bus):
    """In place of the bus and the master of simulated time: each greeting is answered by the next release."""

    releases = ()

    def subscribe(self, key, receive):
        super().subscribe(key, receive)
        if key == f"{clock.RELEASE}/fsm":
            self.receive, self.left = receive, list(self.releases)

    def put(self, key, payload, lossless=True):
        super().put(key, payload, lossless)
        if key == f"{clock.HELLO}/fsm" and self.left:
            t_ns = self.left.pop(0)
            for writer, at in ((b"another", 7_000_000_000), (b"another", clock.STOP_NS), (b"hub", t_ns)):
                payload = Marked(clock.pack_release(clock.Release(at, {})))
                payload.writer = writer
                self.receive(f"{clock.RELEASE}/fsm", payload)

    def hub_marks(self):
        return (b"hub",)

    def said(self, key):
        return [payload for at, payload in self.sent if at == key]


@pytest.fixture
def follower(process, monkeypatch):
    """Makes a runner of `Counter` that is released at the given times, one for each greeting."""
    monkeypatch.setattr(runner, "Session", Clock)
    monkeypatch.setattr(runner, "_LOOK_S", 0.01)
    monkeypatch.setattr(runner, "_GREET_S", 0.0)
    monkeypatch.setattr(Told, "looks", 10**6)

    def make(*releases):
        monkeypatch.setattr(Clock, "releases", releases)
        return process(Counter, which="simulated")

    return make


def test_a_release_that_comes_again_is_answered_again_without_another_step(follower):
    fsm = follower(4_000_000, 4_000_000, 8_000_000, 8_000_000, clock.STOP_NS)
    assert fsm.run() == 0
    bus = fsm._session
    answers = [clock.unpack_done(payload) for payload in bus.said(f"{clock.DONE}/fsm")]
    assert [answer.t_ns for answer in answers] == [4_000_000, 4_000_000, 8_000_000, 8_000_000]
    assert answers[0] == answers[1] and answers[2] == answers[3]
    assert fsm._stepper.component.steps == 2 and len(bus.said("fsm/event")) == 2
    first, *more = [clock.unpack_hello(payload) for payload in bus.said(f"{clock.HELLO}/fsm")]
    assert first == clock.Hello(0) and set(more) == {clock.Hello(0, new=False)}
    assert fsm._stepper.buffers.bad == 10 and "a second clock releases" in fsm._stepper.buffers.incidents.words(
        0.0
    )


def test_a_clock_that_goes_back_belongs_to_another_run(follower):
    fsm = follower(4_000_000, 8_000_000, 0)
    with pytest.raises(AnotherRun, match=r"from 0\.008 s to 0\.0 s"):
        fsm.run()
    assert not fsm._session.open
