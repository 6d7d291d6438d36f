"""A supervisor killed at any moment leaves no process behind."""

import time

import pytest

from surefoot.bus.topics import PROCESSES


# The guardian and io before the bus is open; the others when they have only just been started.
@pytest.mark.parametrize("count", [2, len(PROCESSES) + 1])
def test_killed_while_it_starts(supervised, count):
    live = supervised(until_up=False)
    pids = []
    while len(pids) < count:
        pids = live.children()
        assert live.run.poll() is None, live.said()
    live.run.kill()
    live.wait_gone(pids)


def test_killed_while_it_stops(supervised):
    live = supervised("run.command=stand")
    live.pids()
    pids = live.children()
    assert len(pids) == len(PROCESSES) + 1
    live.run.terminate()
    while len(live.children()) == len(pids):
        time.sleep(0.001)
    live.run.kill()
    live.wait_gone(pids)
