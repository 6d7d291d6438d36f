"""A process on the monotonic clock lets go of the robot before it leaves, whatever ended it."""

from dataclasses import replace

import numpy as np
import pytest

from surefoot.bus.codec import decode
from surefoot.bus.messages import JointCommand, ProcessStatus
from surefoot.components import runner
from surefoot.components.component import Component
from surefoot.components.wbc.wbc import Wbc
from surefoot.config.deployment import Deployment, Run


class Bus:
    """In place of the session: keeps what is published."""

    def __init__(self, *args, **kwargs):
        self.sent, self.open = [], True

    def put(self, key, payload, lossless=True):
        assert self.open
        self.sent.append((key, payload))

    def newest(self, key):
        return lambda: None

    def subscribe(self, key, receive):
        pass

    serve = serve_each = subscribe

    def close(self):
        self.open = False

    def lives(self):
        return [decode(ProcessStatus, payload).life for key, payload in self.sent if key.startswith("status/")]


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

    def make(kind, clock="monotonic"):
        monkeypatch.setattr(runner, "component_class", lambda name: kind)
        return runner.Runner(replace(Deployment(), run=Run(clock=clock)), kind.name)

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


def test_the_last_command_of_the_whole_body_controller_brakes(process):
    wbc = process(Wbc)
    wbc.run()
    last = decode(JointCommand, next(payload for key, payload in wbc._session.sent if key == "joint/command"))
    assert last.valid and not last.kp.any() and not last.tau.any()
    np.testing.assert_array_equal(last.kd, Deployment().hw.damping_kd)
