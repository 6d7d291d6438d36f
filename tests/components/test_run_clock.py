"""Another machine's time of the run is never ahead of io's, and that of another run is not followed."""

import os
import time
from dataclasses import replace
from itertools import chain, repeat
from math import nan
from threading import Event

import msgpack
import pytest

from surefoot.bus.errors import BusError
from surefoot.bus.session import Session
from surefoot.components import run_clock
from surefoot.components.run_clock import AnotherRun, HubClock, serve_time
from surefoot.config.deployment import Deployment, Run

NAMESPACE = f"clock-{os.getpid()}"


def deployment(age_s, speed=1.0):
    """A run that began so long ago."""
    return replace(Deployment(), run=Run(clock="monotonic", speed=speed, epoch_s=time.monotonic() - age_s))


@pytest.fixture
def clock_of():
    """Makes clocks of a process that goes on until the test is over, and is told nothing wrong."""
    over = Event()
    yield lambda client: HubClock(client, over.is_set, pytest.fail)
    over.set()


@pytest.fixture
def hub():
    session = Session(NAMESPACE, hub=True)
    yield session
    session.close()


@pytest.fixture
def client(hub):
    session = Session(NAMESPACE, connect_ms=5000)
    yield session
    session.close()


def test_it_is_behind_by_no_more_than_an_answer_took_and_never_ahead(hub, client, clock_of):
    run = deployment(100.0)
    serve_time(hub, run)
    clock = clock_of(client)
    for _ in range(100):
        before = time.monotonic() - run.run.epoch_s
        t = clock()
        after = time.monotonic() - run.run.epoch_s
        assert before - clock.behind_s - 1e-6 <= t <= after
        clock.ask()


def test_a_run_that_goes_slower_than_time_does_so_on_every_machine(hub, client):
    run = deployment(100.0, speed=0.25)
    serve_time(hub, run)
    there = HubClock(client, lambda: True, pytest.fail, run.run.speed)
    here = run_clock.run_clock(client, run, lambda: True, pytest.fail)
    for _ in range(3):
        t = there()
        assert t <= here() < t + there.behind_s + 0.1
        time.sleep(0.2)
    assert 25.0 < here() < 0.25 * (time.monotonic() - run.run.epoch_s) + 1e-9


def test_it_goes_on_without_answers_and_never_back(hub, client, monkeypatch, clock_of):
    serve_time(hub, deployment(5.0))
    clock = clock_of(client)
    monkeypatch.setattr(client, "ask", lambda key, timeout_s: [])
    first = clock()
    assert not clock.ask()
    time.sleep(0.02)
    assert clock() - first >= 0.02
    clock._offset -= 1.0  # a later answer says that this machine's clock runs ahead
    later = clock()
    assert clock() == later


def test_another_run_is_not_followed(hub, client, clock_of):
    serve_time(hub, deployment(5.0))
    clock = clock_of(client)
    clock()
    clock._run += 1.0  # as if it had been begun with another hub
    clock.ask()
    with pytest.raises(AnotherRun, match="start this machine's part again"):
        clock()


def test_it_waits_for_the_first_answer_until_told_to_end(hub, client, monkeypatch):
    monkeypatch.setattr(run_clock, "_ASK_AGAIN_S", 0.01)
    looks = iter([False, False, True])
    HubClock(client, lambda: next(looks, True), pytest.fail)
    assert next(looks, "none left") == "none left"


@pytest.mark.parametrize(
    "said", [b"\xc1", msgpack.packb([1.0]), msgpack.packb([1.0, "a"]), msgpack.packb([1.0, nan])]
)
def test_an_answer_that_is_none_is_told_and_it_is_asked_again(hub, client, monkeypatch, said):
    """On and on, whatever goes wrong: without an answer nobody would know that the run is another."""
    monkeypatch.setattr(run_clock, "_PERIOD_S", 0.01)
    serve_time(hub, deployment(5.0))
    dropped = []
    clock = HubClock(client, lambda: False, dropped.append)
    run = clock._run
    answers = chain([[said], BusError("the link broke")], repeat([msgpack.packb([run + 1.0, 0.0])]))

    def play(key, timeout_s):
        answer = next(answers)
        if isinstance(answer, BusError):
            raise answer
        return answer

    monkeypatch.setattr(client, "ask", play)
    assert clock._another.wait(60.0)
    assert "clock/now: no time of a run" in dropped[0] and dropped[1:] == ["clock/now: the link broke"]
