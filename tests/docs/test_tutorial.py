"""The tutorial from beginning to end: each command is executed, in order, with a robot that really walks."""

import os
import re
import shlex
import subprocess
import sys
import tempfile
import time

import pytest
from markdown_pages import ROOT, blocks

from surefoot.bus.codec import decode
from surefoot.bus.errors import BusError
from surefoot.bus.messages import MotionReference
from surefoot.bus.session import Session

PAGE = ROOT / "docs" / "tutorial.md"
PATIENCE_S = 300.0  # of wall time: other jobs share the cores, and nothing is decided by it
FIRST, SETUP = "first terminal", "git clone"
WAIT = re.compile(r"Wait until the (?:state is `(\w+)`|run has ended)")  # a state, or the end


def story():
    """The page's blocks and waits in its order."""
    text, steps = PAGE.read_text(), []
    for block in blocks(PAGE):
        before, _, text = text.partition(block.text)
        steps += [("wait", state) for state in WAIT.findall(before)]
        steps.append((block.kind.removeprefix("sh").strip(), block.text))
    return steps


class Reader:
    """Who follows the tutorial, in a folder and with a bus of their own."""

    def __init__(self, folder):
        self.folder = folder
        program = folder / "bin" / "surefoot"
        program.parent.mkdir()
        program.write_text(f'#!/bin/sh\nexec {shlex.quote(sys.executable)} -P -m surefoot.tools.cli "$@"\n')
        program.chmod(0o755)
        path = f"{program.parent}{os.pathsep}{os.environ['PATH']}"
        self.env = os.environ | {"PATH": path, "TMPDIR": str(folder), "PYTHONPATH": str(ROOT / ".import")}
        self.run = None

    def start(self, text):
        """In the first terminal."""
        output = (self.folder / "first").open("wb")
        words = shlex.split(text)
        self.run = subprocess.Popen(words, cwd=self.folder, env=self.env, stdout=output, stderr=output)

    def type(self, line):
        """In the second terminal; the exit code and what it printed."""
        done = subprocess.run(shlex.split(line), cwd=self.folder, env=self.env, capture_output=True, text=True)
        return done.returncode, done.stdout + done.stderr

    def wait(self, state):
        """Until the state machine says so."""
        session, end = None, time.monotonic() + PATIENCE_S
        while session is None:
            assert self.run.poll() is None and time.monotonic() < end, self.said()
            try:
                session = Session("surefoot", connect_ms=1000)
            except BusError:
                time.sleep(0.2)
        newest = session.newest("fsm/reference")
        while (payload := newest()) is None or decode(MotionReference, payload).state != state:
            assert self.run.poll() is None and time.monotonic() < end, f"no {state}: {self.said()}"
            time.sleep(0.005)
        session.close()

    def said(self):
        """In the first terminal."""
        return (self.folder / "first").read_text()

    def close(self):
        """Leave nothing behind."""
        if self.run is not None and self.run.poll() is None:
            self.run.terminate()
            self.run.wait(60.0)


@pytest.fixture
def reader(tmp_path, monkeypatch):
    """In a folder that is empty."""
    monkeypatch.setattr(tempfile, "tempdir", str(tmp_path))  # where the bus's socket is
    made = Reader(tmp_path)
    yield made
    made.close()


def test_every_step_works(reader):
    printed = {}
    for kind, text in story():
        if kind == "wait":
            reader.wait(text) if text else reader.run.wait(PATIENCE_S)
        elif kind == FIRST:
            reader.start(text)
        elif SETUP not in text:
            for line in text.splitlines():
                code, printed[line] = reader.type(line)
                # On a busy machine a process may be late, and an answer: the command was given all the same.
                late = line.startswith("surefoot status") or "no answer in 3 s" in printed[line]
                assert code == 0 or (late and code == 1), f"{line}\n{printed[line]}\n{reader.said()}"
    assert reader.run.returncode == 0 and "damped by command" in reader.said()
    assert "nothing is missing" in printed["surefoot info walk.mcap"]
    assert '"state": "' in printed["surefoot status --json"]
    assert "swing_height" in next(said for line, said in printed.items() if "--diff" in line)
    assert "success 1 of 1" in (reader.folder / "out" / "summary.md").read_text()


def test_the_first_block_asks_make_for_what_it_has():
    setup = next(text for _, text in story() if SETUP in text)
    goals = [line.split("#")[0].split()[1] for line in setup.splitlines() if line.startswith("make ")]
    done = subprocess.run(["make", "--dry-run", *goals], cwd=ROOT, capture_output=True, text=True)
    assert goals == ["install"] and done.returncode == 0, done.stderr
