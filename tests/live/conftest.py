"""Stacks of processes over Zenoh, started by hand or by `surefoot run`, and all that they publish."""

import json
import os
import signal
import subprocess
import sys
import threading
import time
from contextlib import suppress
from pathlib import Path

import pytest

from surefoot.bus.codec import decode
from surefoot.bus.errors import BusError
from surefoot.bus.messages import ProcessStatus
from surefoot.bus.session import Session
from surefoot.bus.topics import PROCESSES, TOPICS
from surefoot.components import clock_messages as clock
from surefoot.config.deployment import load_deployment

KEYS = [key for key in TOPICS if not key.startswith("status/")]
CLI = [sys.executable, "-P", "-m", "surefoot.tools.cli"]
PATIENCE_S = 180.0  # of wall time: other jobs share the cores, and no test is decided by it


def wait(holds, told=lambda: ""):
    """Until `holds()`; fails with `told()` when patience is at its end."""
    end = time.monotonic() + PATIENCE_S
    while not holds():
        assert time.monotonic() < end, told()
        time.sleep(0.05)


class Ear:
    """All that is published under a namespace."""

    def __init__(self, namespace):
        self.heard = {key: [] for key in KEYS}
        self.status = {}
        self.lock = threading.Lock()
        end = time.monotonic() + PATIENCE_S
        while True:
            try:
                self.session = Session(namespace, connect_ms=1000)
                break
            except BusError:
                assert time.monotonic() < end, "the hub did not come up"
        for key in KEYS:
            self.session.subscribe(key, self._hear)
        self.session.subscribe("status/*", self._hear_status)

    def _hear(self, key, payload):
        with self.lock:
            self.heard[key].append(payload)

    def _hear_status(self, key, payload):
        self.status[key.split("/")[1]] = decode(ProcessStatus, payload)

    def last(self, key):
        """The newest message of a topic."""
        with self.lock:
            return decode(TOPICS[key].message, self.heard[key][-1])

    def t(self):
        """Simulated time [s]; -1 while it has not begun."""
        return self.last("hw/state").t if self.heard["hw/state"] else -1.0

    def reason(self, process):
        """What a process says of its health."""
        status = self.status.get(process)
        return status.reason if status is not None else ""

    def wait(self, holds):
        """Until `holds()`."""
        wait(holds, lambda: f"t = {self.t()}, { {n: s.reason for n, s in self.status.items()} }")

    def go_on(self, seconds):
        """Until so much simulated time has passed."""
        end = self.t() + seconds
        self.wait(lambda: self.t() >= end)

    def stands(self):
        """Whether the robot is at its height, on its feet alone."""
        truth = self.last("sim/truth")
        return truth.p_WB[2] > 0.37 and truth.body_contact == ""


class Stack(Ear):
    """The processes of a deployment on flat ground, started by hand."""

    def __init__(self, tmp_path, overrides=(), leave_out=()):
        self.namespace = f"test-{os.getpid()}-{tmp_path.name}"
        self.config, self.log = tmp_path / "live.toml", (tmp_path / "log").open("ab")
        self.config.write_text('[terrain]\nkind = "flat"\n')
        self.overrides = [f"run.namespace={self.namespace}", *overrides]
        self.deployment = load_deployment(self.config, self.overrides)
        self.children, self.boots = {}, {}
        self.start("io")
        super().__init__(self.namespace)
        for process in PROCESSES:
            if process != "io" and process not in leave_out:
                self.start(process)

    def start(self, process, boot=0):
        """Start one process."""
        settings = [word for override in self.overrides for word in ("--set", override)]
        command = [*CLI, "child", str(self.config), process, *settings, "--boot", str(boot)]
        self.children[process] = subprocess.Popen(command, stdout=self.log, stderr=self.log)

    def restart(self, *names):
        """End some processes at once, by force, and start them again; until they run."""
        for name in names:
            self.children[name].kill()
        boots = {}
        for name in names:
            self.children[name].wait()
            boots[name] = self.boots[name] = self.boots.get(name, 0) + 1
            self.start(name, boots[name])
        self.wait(lambda: all(self.status[name].boot == boot for name, boot in boots.items()))

    def begin(self, command):
        """Give a command while time still stands at 0, then let the last process come up."""
        self.wait(lambda: "io" in self.status)
        self.session.put(clock.REQUEST, command)
        time.sleep(0.3)
        self.start("trajopt")

    def close(self):
        """End all."""
        for child in self.children.values():
            child.send_signal(signal.SIGCONT)
            child.terminate()
        for child in self.children.values():
            try:
                child.wait(5.0)
            except subprocess.TimeoutExpired:
                child.kill()
                child.wait()
        self.session.close()
        self.log.close()


def gone(pid):
    """Whether a process has ended, waited for or not."""
    try:
        stat = Path(f"/proc/{pid}/stat").read_text()
    except (FileNotFoundError, ProcessLookupError):
        return True
    return stat.rsplit(")", 1)[1].split()[0] == "Z"


class Supervised(Ear):
    """A run of `surefoot run flat --plain`."""

    def __init__(self, tmp_path, *settings, flags=(), env=None, until_up=True):
        self.namespace = f"test-{os.getpid()}-{tmp_path.name}"
        self.output = tmp_path / "output"
        words = [f"run.namespace={self.namespace}", f"run.log_dir={tmp_path / 'logs'}", *settings]
        command = [*CLI, "run", "flat", "--plain", *flags]
        command += [word for setting in words for word in ("--set", setting)]
        self.session, self.lent = None, []
        with self.output.open("wb") as output:
            self.run = subprocess.Popen(command, stdout=output, stderr=output, env=env)
        if until_up:
            super().__init__(self.namespace)

    def borrow(self, name, *program):
        """Run one of its processes by hand, by a program of one's own if there is one."""
        command = [*(CLI[:2] if program else CLI), *program, "child", "flat", name, "--namespace", self.namespace]
        pipe = subprocess.PIPE
        self.lent.append(subprocess.Popen(command, stdin=pipe, stdout=pipe, stderr=subprocess.STDOUT, text=True))
        return self.lent[-1]

    def asked(self):
        """What `surefoot status --json` says, and its exit code."""
        command = [*CLI, "status", "--json", "--namespace", self.namespace]
        answer = subprocess.run(command, capture_output=True, text=True)
        return json.loads(answer.stdout), answer.returncode

    def children(self):
        """Process ids of those that the supervisor has started and that live."""
        stats = {}
        for entry in Path("/proc").glob("[0-9]*/stat"):
            with suppress(FileNotFoundError, ProcessLookupError):
                stats[int(entry.parent.name)] = int(entry.read_text().rsplit(")", 1)[1].split()[1])
        return [pid for pid, parent in stats.items() if parent == self.run.pid and not gone(pid)]

    def wait_gone(self, pids):
        """Until none of the processes is left."""
        wait(lambda: all(gone(pid) for pid in pids), lambda: f"left: {[pid for pid in pids if not gone(pid)]}")

    def command(self, *words):
        """Another `surefoot` command for this run."""
        subprocess.run([*CLI, *words, "--namespace", self.namespace], check=True, stdout=subprocess.DEVNULL)

    def pids(self):
        """Of the processes, once all have spoken."""
        self.wait(lambda: len(self.status) == len(PROCESSES))
        return [status.pid for status in self.status.values()]

    def wait_end(self):
        """Until the run has ended."""
        wait(lambda: self.run.poll() is not None, self.said)

    def said(self):
        """What the run has printed."""
        return self.output.read_text()

    def log(self, name):
        """The log of a process, or of the supervisor."""
        return (self.output.parent / "logs" / f"{name}.log").read_text()

    def close(self):
        """End all."""
        if self.run.poll() is None:
            self.run.terminate()
        try:
            self.run.wait(30.0)
        except subprocess.TimeoutExpired:
            self.run.kill()
            self.run.wait()
        for child in self.lent:
            child.kill()
            child.communicate()
        if self.session is not None:
            self.session.close()


@pytest.fixture
def stack(tmp_path):
    """Makes a `Stack`."""
    yield from _closing(lambda *args, **kwargs: Stack(tmp_path, *args, **kwargs))


@pytest.fixture
def supervised(tmp_path):
    """Makes a `Supervised` run."""
    yield from _closing(lambda *args, **kwargs: Supervised(tmp_path, *args, **kwargs))


def _closing(make):
    made = []

    def keep(*args, **kwargs):
        made.append(make(*args, **kwargs))
        return made[-1]

    yield keep
    for each in made:
        each.close()
