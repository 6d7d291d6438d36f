"""`surefoot run` on a terminal: it examines the robot, asks before each motion, stands it, and sets it down."""

import os
import pty
import select
import subprocess
import sys
import time
from contextlib import contextmanager, suppress

from emulation import PATIENT, emulator

from surefoot.config.aliengo import Aliengo
from surefoot.config.deployment import Deployment, Run
from surefoot.config.emulator import Emulator
from surefoot.config.hw import Hw

CLI = [sys.executable, "-P", "-m", "surefoot.tools.cli"]
PATIENCE_S = 180.0  # of wall time: other jobs share the cores, and no test is decided by it


class Terminal:
    """A person at the terminal of a run.

    Attributes:
        seen: all that was on it.
    """

    def __init__(self, command):
        self._fd, end = pty.openpty()
        self.run = subprocess.Popen(command, stdin=end, stdout=end, stderr=end, start_new_session=True)
        os.close(end)
        self.seen = ""

    def reads(self, words):
        """Until these words are there; what comes after them is still to be read."""
        end = time.monotonic() + PATIENCE_S
        begin = len(self.seen)
        while words not in self.seen[begin:]:
            assert time.monotonic() < end and self.run.poll() is None, self.seen
            self._read()

    def reads_on(self):
        """Until the run is over."""
        with suppress(OSError):  # nobody holds the other end any more
            while self.run.poll() is None:
                self._read()
        assert self.run.wait(PATIENCE_S) == 0, self.seen

    def types(self, line):
        os.write(self._fd, f"{line}\n".encode())

    def _read(self):
        if select.select([self._fd], [], [], 0.2)[0]:
            self.seen += os.read(self._fd, 65536).decode(errors="replace")

    def close(self):
        self.run.terminate()
        try:
            self.run.wait(30.0)
        finally:
            self.run.kill()
            os.close(self._fd)


@contextmanager
def guided(tmp_path, *settings):
    wire = Aliengo(exchange="cycle", **PATIENT)
    there = Deployment(
        run=Run(command=""),
        hw=Hw(backend="aliengo", start="lying", aliengo=wire),
        emulator=Emulator(pace="packets"),
    )
    with emulator(there) as emulation:
        words = [
            f"run.namespace=test-{os.getpid()}-{tmp_path.name}",
            f"run.log_dir={tmp_path}",
            "run.clock=simulated",
            "hw.aliengo.exchange=cycle",
            "hw.aliengo.local_port=0",
            f"hw.aliengo.port={emulation.server.port}",
            *settings,
        ]
        terminal = Terminal(
            [*CLI, "run", "aliengo_emulated", *(word for each in words for word in ("--set", each))]
        )
        try:
            yield terminal, emulation.robot
        finally:
            terminal.close()


def test_a_robot_that_lies_is_examined_asked_for_stands_and_sits_down_before_the_run_ends(tmp_path):
    with guided(tmp_path, "hw.aliengo.first_answer_s=60", "fsm.hold_s=0.2") as (terminal, robot):
        terminal.reads("the robot is sent zero gains")
        for question, answer in (("Does it hang (h)", "l"), ("Bring up the gains?", "y"), ("Stand up?", "y")):
            terminal.reads(question)
            terminal.types(answer)
        terminal.reads("It stands.")
        assert "level: tilted by" in terminal.seen and robot.plant.truth().p_WB[2] > 0.3
        terminal.run.terminate()
        terminal.reads_on()
        assert "the robot sits down before the run ends" in (tmp_path / "supervisor.log").read_text()
        lying = robot.plant.truth()
        assert lying.p_WB[2] < 0.2 and abs(lying.quat_WB[0]) > 0.99


def test_a_robot_that_does_not_answer_is_not_started(tmp_path):
    with guided(tmp_path, "hw.aliengo.first_answer_s=0.2", "hw.aliengo.port=9") as (terminal, robot):
        terminal.reads("not started: answer")
        assert terminal.run.wait(PATIENCE_S) == 1
    assert robot.commands == 0 and not list(tmp_path.glob("*.log"))
