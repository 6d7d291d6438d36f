"""Restarts asked for in any order and number are carried out one after the other, each once."""

import pytest

from surefoot.bus.messages import ProcessStatus
from surefoot.tools.picture import Picture
from surefoot.tools.restart_queue import RestartQueue


class Desk:
    """A queue, its picture and a clock."""

    def __init__(self):
        self.picture, self.t = Picture(), 0.0
        self.queue = RestartQueue(self.picture, 30.0, lambda: self.t)
        for name in self.picture.processes:
            self.up(name, 0)

    def up(self, name, boot, steps=5, nominal_hz=100.0, reason=""):
        self.picture.note_status(
            ProcessStatus(process=name, boot=boot, steps=steps, nominal_hz=nominal_hz, reason=reason)
        )

    def go(self):
        """The next restart, as the supervisor carries it out."""
        due = self.queue.next()
        if due is not None:
            watched = self.picture.processes[due[0]]
            watched.restarts += 1
            watched.status = None
        return due


@pytest.fixture
def desk():
    return Desk()


def test_the_next_one_goes_when_the_last_one_steps_again(desk):
    assert desk.queue.add("wbc", "on request") == "" and desk.queue.add("mpc", "on request") == ""
    assert desk.go() == ("wbc", "on request")
    assert desk.go() is None
    desk.up("wbc", 0)  # the last words of the one that was ended
    assert desk.go() is None
    desk.up("wbc", 1, steps=0)
    assert desk.go() is None
    desk.up("wbc", 1, steps=1)
    assert desk.go() == ("mpc", "on request")


def test_a_storm_is_two_restarts_and_one_note(desk):
    desk.queue.add("mpc", "on request")
    assert desk.go() == ("mpc", "on request")
    said = [desk.queue.add("mpc", "on request") for _ in range(50)]
    assert said == ["mpc is restarted as soon as mpc is up again", *[""] * 49]
    assert desk.go() is None
    desk.up("mpc", 1)
    assert desk.go() == ("mpc", "on request")
    desk.up("mpc", 2)
    assert desk.go() is None


def test_one_that_steps_on_events_is_up_when_it_speaks(desk):
    desk.queue.add("trajopt", "")
    desk.queue.add("mpc", "")
    desk.go()
    desk.up("trajopt", 1, steps=0, nominal_hz=0.0)
    assert desk.go() == ("mpc", "")


def test_the_one_that_simulated_time_waits_for_goes_first(desk):
    """Nobody else steps before it: to wait for the others' first step would be for ever."""
    desk.queue.add("mpc", "")
    desk.go()
    desk.up("mpc", 1, steps=0)
    for name in ("fsm", "wbc"):
        desk.queue.add(name, "")
    desk.up("io", 0, reason="simulated time waits for wbc, 2.0 s now")
    assert desk.go() == ("wbc", "")


def test_one_that_does_not_come_up_holds_up_the_others_for_so_long_only(desk):
    desk.queue.add("mpc", "")
    desk.queue.add("wbc", "")
    desk.go()
    desk.t = 29.0
    assert desk.go() is None
    desk.t = 31.0
    assert desk.go() == ("wbc", "")
    desk.picture.processes["wbc"].out = "ended with exit code 1"
    desk.queue.add("fsm", "")
    assert desk.go() == ("fsm", "")
