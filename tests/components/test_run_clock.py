"""Another machine's time of the run is never ahead of io's, and that of another run is not followed."""

import os
import time
from dataclasses import replace

import pytest

from surefoot.bus.session import Session
from surefoot.components import run_clock
from surefoot.components.run_clock import AnotherRun, HubClock, serve_time
from surefoot.config.deployment import Deployment, Run

NAMESPACE = f"clock-{os.getpid()}"


def deployment(age_s):
    """A run that began so long ago."""
    return replace(Deployment(), run=Run(clock="monotonic", epoch_s=time.monotonic() - age_s))


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


def test_it_is_behind_by_no_more_than_an_answer_took_and_never_ahead(hub, client):
    run = deployment(100.0)
    serve_time(hub, run)
    clock = HubClock(client)
    for _ in range(100):
        before = time.monotonic() - run.run.epoch_s
        t = clock()
        after = time.monotonic() - run.run.epoch_s
        assert before - clock.behind_s - 1e-6 <= t <= after
        clock.ask()


def test_it_goes_on_without_answers_and_never_back(hub, client, monkeypatch):
    serve_time(hub, deployment(5.0))
    clock = HubClock(client)
    monkeypatch.setattr(client, "ask", lambda key, timeout_s: [])
    first = clock()
    assert not clock.ask()
    time.sleep(0.02)
    assert clock() - first >= 0.02
    clock._offset -= 1.0  # a later answer says that this machine's clock runs ahead
    later = clock()
    assert clock() == later


def test_another_run_is_not_followed(hub, client):
    serve_time(hub, deployment(5.0))
    clock = HubClock(client)
    clock()
    clock._run += 1.0  # as if it had been begun with another hub
    clock.ask()
    with pytest.raises(AnotherRun, match="start this machine's part again"):
        clock()


def test_it_waits_for_the_first_answer_until_told_to_end(hub, client, monkeypatch):
    monkeypatch.setattr(run_clock, "_ASK_AGAIN_S", 0.01)
    looks = iter([False, False, True])
    HubClock(client, lambda: next(looks))
    assert next(looks, "none left") == "none left"
