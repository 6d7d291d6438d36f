"""A supervisor killed at any moment leaves no process behind."""

import time

from surefoot.bus.topics import PROCESSES


def test_killed_before_the_bus_is_open(supervised):
    live = supervised(until_up=False)
    pids = []
    while len(pids) < 2:  # the guardian and io
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
