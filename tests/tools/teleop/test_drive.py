"""`surefoot drive` in a real terminal (a pseudo-terminal), on a stack that answers."""

import os
import pty
import re
import select
import signal
import subprocess
import sys
import termios
import time

import pytest
from driven import PATIENCE_S, Driven

CLI = [sys.executable, "-P", "-m", "surefoot.tools.cli"]


class Terminal:
    """A person's terminal with `surefoot drive` in it.

    Attributes:
        text: all that was drawn, without colours and moves of the cursor.
    """

    def __init__(self, namespace):
        self.master, self.slave = pty.openpty()
        termios.tcsetwinsize(self.slave, (40, 110))
        self.before = termios.tcgetattr(self.slave)
        self.process = subprocess.Popen(
            [*CLI, "drive", "--namespace", namespace],
            stdin=self.slave,
            stdout=self.slave,
            stderr=self.slave,
            env=os.environ | {"TERM": "xterm-256color", "COLUMNS": "110", "LINES": "40"},
        )
        self.text = ""

    def type(self, keys):
        os.write(self.master, keys.encode())

    def look(self):
        while select.select([self.master], [], [], 0.05)[0]:
            drawn = os.read(self.master, 65536).decode(errors="replace")
            self.text += re.sub(r"\x1b\[[0-9;?]*[A-Za-z]", "", drawn)

    def wait(self, holds):
        end = time.monotonic() + PATIENCE_S
        while not holds():
            self.look()
            assert time.monotonic() < end, self.text[-3000:]
            assert self.process.poll() is None or holds(), self.text[-3000:]

    def shows(self, words):
        self.wait(lambda: words in self.text)

    def ends(self, code):
        self.wait(lambda: self.process.poll() is not None)
        assert self.process.returncode == code, self.text[-3000:]
        found = termios.tcgetattr(self.slave)
        assert found[:4] == self.before[:4] and found[6] == self.before[6]

    def close(self):
        self.process.kill()
        self.process.wait()
        os.close(self.master)
        os.close(self.slave)


@pytest.fixture
def drive():
    """Makes a stack and a terminal at it."""
    made = []

    def make(**settings):
        stack = Driven(**settings)
        made.append(stack)
        stack.come_to("STAND")
        terminal = Terminal(stack.namespace)
        made.append(terminal)
        terminal.shows("arrows or w ahead")
        return stack, terminal

    yield make
    for each in reversed(made):
        each.close()


def test_keys_are_commands_and_the_screen_shows_what_comes_of_them(drive):
    stack, terminal = drive(probe_around=False, alternatives=1, put_off=False)
    stack.hold_in("PROBE")
    terminal.type("\x1b[A")
    terminal.shows("forward: the robot sets off")
    stack.wait_held()
    terminal.shows("leg RL, planned foothold")
    stack.robot.sunk[2], stack.robot.unanswered = 0.04, ("plan",)
    stack.go_on()
    terminal.shows("alternative 1 of 1")
    terminal.type("k")
    terminal.shows("RL has given up: no safe foothold among the alternatives")
    terminal.shows("collapsed: the foot moved 4.0 cm")
    terminal.shows("given up: skipped by command")
    stack.robot.unanswered = ()
    stack.come_to("STOPPED")
    terminal.type("n")
    terminal.shows("refused  step: the walk is over")
    stack.hold_in("DETECT_CONTACT")
    terminal.type("d")
    terminal.shows("right: the robot sets off")
    stack.wait_held()
    terminal.type("p")
    terminal.shows("pause: after the step of")
    stack.go_on()
    terminal.shows("STOPPED  commanded pause")
    terminal.type("p")
    terminal.shows("resume: the walk goes on")
    terminal.type("q")
    terminal.ends(0)
    assert stack.commands == ["forward", "skip", "step", "right", "pause", "resume"]


def test_a_cut_is_asked_for_twice(drive):
    stack, terminal = drive()
    terminal.type("X")
    terminal.shows("y: cut; any other key: no")
    terminal.type("w")  # no
    terminal.type("k")
    terminal.shows("refused  skip: the robot does not walk in STAND")
    assert stack.commands == ["skip"]
    terminal.type("Xy")
    terminal.shows("cut: no torque before damp is said")
    assert stack.commands == ["skip", "cut"]


def test_with_a_heartbeat_the_robot_whose_driver_leaves_sits_down(drive):
    stack, terminal = drive(heartbeat_s=4.0)
    terminal.type("w")
    stack.come_to("MOVE")
    terminal.type("q")
    terminal.ends(0)
    stack.come_to("DAMP")
    assert stack.commands == ["forward", "sit: no heartbeat for 4 s"]


@pytest.mark.parametrize(("number", "code"), [(signal.SIGTERM, 143), (signal.SIGHUP, 129), (signal.SIGINT, 0)])
def test_the_terminal_is_left_as_it_was_found_whatever_ends_it(drive, number, code):
    _, terminal = drive()
    assert not termios.tcgetattr(terminal.slave)[3] & termios.ECHO
    terminal.process.send_signal(number)
    terminal.ends(code)


def test_a_stack_that_ends_ends_it(drive):
    stack, terminal = drive()
    stack.close()
    stack.close = lambda: None
    terminal.ends(1)
    assert "the stack has ended" in terminal.text


def test_what_is_no_terminal_is_refused():
    call = subprocess.run([*CLI, "drive"], stdin=subprocess.DEVNULL, capture_output=True, text=True)
    assert call.returncode == 2 and "this is none; start it in one (ssh -t)" in call.stderr
