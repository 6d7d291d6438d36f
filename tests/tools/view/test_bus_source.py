"""The view of a running stack, on a real bus on which the processes are only played."""

import os
import threading
import time
from pathlib import Path

import numpy as np
import pytest

from surefoot.bus.codec import encode
from surefoot.bus.errors import BusError
from surefoot.bus.messages import FootholdRequest, FsmEvent, MotionReference, StateEstimate
from surefoot.bus.service_keys import REQUEST
from surefoot.bus.session import Session
from surefoot.components.deployment_desk import serve_deployment
from surefoot.config.deployment import load_deployment
from surefoot.tools.cli import main
from surefoot.tools.commands.call import deployment_file
from surefoot.tools.view.bus_source import BusSource
from surefoot.tools.view.page import Page
from surefoot.tools.view.view_process import ViewProcess

PATIENCE_S = 60.0  # other jobs share the cores, and no test is decided by it
"""Of wall time."""


class PlayedStack:
    """A hub that says where a robot is and what its state machine does."""

    def __init__(self, namespace):
        self.session = Session(namespace, hub=True)
        serve_deployment(self.session, load_deployment(deployment_file("planks")))
        self._over = threading.Event()
        self._thread = threading.Thread(target=self._play)
        self._thread.start()

    def _play(self):
        count = 0
        while not self._over.wait(0.05):
            t = 0.05 * count
            say = self.session.put
            say("state/estimate", encode(StateEstimate(t=t, seq=count, p_WB=np.array([0.01 * count, 0.0, 0.4]))))
            say("fsm/reference", encode(MotionReference(t=t, seq=count, state="SEND", leg=2)))
            say("fsm/event", encode(FsmEvent(t=t, seq=count, kind="transition", state="SEND", leg=2)))
            say("foothold/request", encode(FootholdRequest(t=t, seq=count, target_WF=np.full((4, 3), 0.5))))
            say("trajopt/plan", b"this is no plan")
            count += 1

    def close(self):
        self._over.set()
        self._thread.join()
        self.session.close()


@pytest.fixture
def namespace(tmp_path):
    return f"test-{os.getpid()}-{tmp_path.name}"


def look(source, until):
    end = time.monotonic() + PATIENCE_S
    while not until():
        assert time.monotonic() < end, (source.words, source.heard)
        source.look()
        time.sleep(0.05)


def test_it_hears_the_robot_the_events_and_the_deployment_and_shows_the_next_run(namespace):
    stack = PlayedStack(namespace)
    source = BusSource(lambda: Session(namespace, connect_ms=1000), wait=False)
    look(source, lambda: source.deployment is not None and source.heard.history.candidates)
    assert source.deployment.terrain.kind == "planks" and source.words == ""
    assert source.heard.history.candidates[0].p_W == pytest.approx(np.full(3, 0.5))
    x = source.heard.estimate.p_WB[0]
    look(source, lambda: source.heard.estimate.p_WB[0] > x)
    stack.close()
    look(source, lambda: "ended" in source.words)
    assert source.heard.estimate is not None  # the last picture stays
    stack = PlayedStack(namespace)
    first = source.deployment
    look(source, lambda: source.deployment is not None and source.deployment is not first)
    source.close()
    stack.close()


def test_a_button_says_its_command_on_the_bus_and_shows_what_becomes_of_it(namespace, tab):
    stack = PlayedStack(namespace)
    asked, over = [], threading.Event()
    stack.session.subscribe(REQUEST, lambda key, payload: asked.append(bytes(payload)))
    page = Page(BusSource(lambda: Session(namespace, connect_ms=1000), wait=False), port=0)
    thread = threading.Thread(target=page.run, args=(over.is_set,))
    thread.start()
    tab.goto(page.url)
    tab.get_by_text("SEND", exact=True).wait_for()
    tab.get_by_text("pause", exact=True).click()
    tab.get_by_text("no answer in").wait_for()  # of a stack that is only played
    assert asked == [b"pause"]
    over.set()
    thread.join()
    page.close()
    stack.close()


@pytest.mark.skipif(not hasattr(os, "SCHED_IDLE"), reason="priorities as Linux has them")
def test_who_draws_gives_way_and_who_takes_messages_does_not(namespace, tmp_path):
    end = time.monotonic() + PATIENCE_S
    with ViewProcess(namespace, 0, tmp_path / "view.log") as view:
        while not view.url():
            assert time.monotonic() < end
            time.sleep(0.05)
        stack = PlayedStack(namespace)  # only now: the view makes Zenoh's threads after it has given way
        zenoh = {}
        while not zenoh:
            assert time.monotonic() < end
            time.sleep(0.05)
            for thread in Path(f"/proc/{view.pid}/task").iterdir():
                if (name := (thread / "comm").read_text().strip()).endswith("-0"):
                    zenoh[name] = os.sched_getscheduler(int(thread.name))
        stack.close()
        assert zenoh == {"app-0": os.SCHED_OTHER}
        assert os.sched_getscheduler(view.pid) == os.SCHED_IDLE


def test_without_a_run_it_says_so_or_waits(namespace, capsys, monkeypatch):
    monkeypatch.setenv("ZENOH_RUNTIME", "()")  # as it is by default, here and for what is started later
    with pytest.raises(BusError):
        BusSource(lambda: Session(namespace, connect_ms=200), wait=False)
    assert main(["view", "--namespace", namespace, "--port", "0"]) == 2
    assert "is `surefoot run` running" in capsys.readouterr().err
    source = BusSource(lambda: Session(namespace, connect_ms=200), wait=True)
    assert "nothing answers" in source.words
    source.close()
