"""Stacks of processes over Zenoh, started by hand or by `surefoot run`, and all that they publish.

The MPC has its light profile where a test does not ask for the paper's, which is half of what a stack computes.
"""

import json
import os
import re
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
from surefoot.tools.keys import make_keys

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
        if payload.writer != self.session.mark:  # what a test itself says is not heard
            with self.lock:
                self.heard[key].append(payload)

    def _hear_status(self, key, payload):
        if payload.writer != self.session.mark:
            self.status[key.split("/")[1]] = decode(ProcessStatus, payload)

    def last(self, key):
        """The newest message of a topic."""
        with self.lock:
            return decode(TOPICS[key].message, self.heard[key][-1])

    def newest(self, key, seconds=1.0):
        """The messages of a topic of the last seconds before its newest."""
        with self.lock:
            payloads = self.heard[key][-round(seconds * TOPICS[key].rate_hz) :]
        messages = [decode(TOPICS[key].message, payload) for payload in payloads]
        return [message for message in messages if message.t > messages[-1].t - seconds]

    def t(self):
        """Simulated time [s]; -1 while it has not begun."""
        return self.last("hw/state").t if self.heard["hw/state"] else -1.0

    def reason(self, process):
        """What a process says of its health."""
        status = self.status.get(process)
        return status.reason if status is not None else ""

    def boot(self, process):
        """How often a process has been restarted; -1 while it has said nothing, as one that was killed young."""
        status = self.status.get(process)
        return status.boot if status is not None else -1

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
        self.config.write_text('[terrain]\nkind = "flat"\n[mpc]\nprofile = "light"\n')
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
        self.wait(lambda: all(self.boot(name) == boot for name, boot in boots.items()))

    def stand_still(self):
        """Let simulated time wait: what a test computes from here on has the machine to itself."""
        self.children["estimator"].send_signal(signal.SIGSTOP)

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
        words = [f"run.namespace={self.namespace}", f"run.log_dir={tmp_path / 'logs'}"]
        words += ["mpc.profile=light", *settings]
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


class Link:
    """Two network namespaces with one cable between them: two machines, as far as the network goes."""

    def __init__(self):
        mark = os.getpid()
        self.names = {"robot": f"sf-robot-{mark}", "laptop": f"sf-laptop-{mark}"}
        self._devices = {"robot": f"sfr{mark}", "laptop": f"sfl{mark}"}
        self.address = {"robot": "10.213.77.1", "laptop": "10.213.77.2"}
        try:
            for name in self.names.values():
                self._ip("netns", "add", name)
            ends = list(self._devices.values())
            self._ip("link", "add", ends[0], "type", "veth", "peer", "name", ends[1])
            for machine, device in self._devices.items():
                self._ip("link", "set", device, "netns", self.names[machine])
                self.on(machine, "ip", "address", "add", f"{self.address[machine]}/24", "dev", device)
                self.on(machine, "ip", "link", "set", "lo", "up")
            self.up()
        except (OSError, subprocess.CalledProcessError) as error:
            self.close()
            pytest.skip(f"network namespaces need root and iproute2: {error} {getattr(error, 'stderr', '')}")

    def command(self, machine, *words):
        """A command as it is run on a machine."""
        return ["ip", "netns", "exec", self.names[machine], *words]

    def on(self, machine, *words):
        """Run a command on a machine."""
        return subprocess.run(self.command(machine, *words), check=True, capture_output=True, text=True).stdout

    def down(self):
        """Pull the cable."""
        self._set("down")

    def up(self):
        """Plug it in."""
        self._set("up")

    def spoil(self, loss_percent, delay_ms):
        """Lose packets both ways, and delay them where the kernel has netem; a skip where it loses none."""
        rule = ("numgen", "random", "mod", "100", "<", str(loss_percent), "counter", "drop")
        hook = ("{", "type", "filter", "hook", "input", "priority", "0", ";", "}")
        try:
            for machine in self.names:
                self.on(machine, "nft", "add", "table", "ip", "worn")
                self.on(machine, "nft", "add", "chain", "ip", "worn", "arrives", *hook)
                arrives = ("iifname", self._devices[machine])
                self.on(machine, "nft", "add", "rule", "ip", "worn", "arrives", *arrives, *rule)
                netem = ("root", "netem", "delay", f"{delay_ms}ms")
                with suppress(OSError, subprocess.CalledProcessError):
                    self.on(machine, "tc", "qdisc", "add", "dev", self._devices[machine], *netem)
        except (OSError, subprocess.CalledProcessError) as error:
            pytest.skip(f"no loss of packets: {getattr(error, 'stderr', error)}")

    def lost(self, machine):
        """How many packets have been lost on their way to a machine."""
        rules = self.on(machine, "nft", "list", "chain", "ip", "worn", "arrives")
        return int(re.search(r"counter packets (\d+)", rules)[1])

    def close(self):
        """Remove both."""
        for name in self.names.values():
            subprocess.run(["ip", "netns", "del", name], check=False, capture_output=True)

    def _set(self, state):
        for machine, device in self._devices.items():
            self.on(machine, "ip", "link", "set", device, state)

    @staticmethod
    def _ip(*words):
        subprocess.run(["ip", *words], check=True, capture_output=True, text=True)


class TwoMachines(Ear):
    """`surefoot run` on two machines by one deployment file; what is heard is heard on the robot's."""

    def __init__(self, tmp_path, link, hosts, *settings):
        self.namespace = f"test-{os.getpid()}-{tmp_path.name}"
        self.link, self.folder = link, tmp_path
        keys = tmp_path / "keys"
        make_keys(keys, [link.address["robot"]], 1)
        self.config = tmp_path / "two.toml"
        lines = [f"{host} = {list(names)!r}" for host, names in hosts.items()]
        self.config.write_text(
            f'[terrain]\nkind = "flat"\n[mpc]\nprofile = "light"\n[run]\nnamespace = "{self.namespace}"\n'
            f'[network]\nlisten = "tls/0.0.0.0:7448"\naddress = "{link.address["robot"]}"\nkeys_dir = "{keys}"\n'
            "[network.hosts]\n" + "\n".join(lines) + "\n"
        )
        self.settings = [word for setting in settings for word in ("--set", setting)]
        self.deployment = load_deployment(self.config, settings)
        self.runs = {}
        self.start("laptop")  # it waits for the robot
        self.start("robot")
        super().__init__(self.namespace)

    def start(self, machine):
        """Begin a machine's part of the run."""
        logs = self.folder / f"logs-{machine}"
        words = [
            "run",
            str(self.config),
            "--host",
            machine,
            "--plain",
            *self.settings,
            "--set",
            f"run.log_dir={logs}",
        ]
        with (self.folder / f"said-{machine}").open("ab") as said:
            self.runs[machine] = subprocess.Popen(
                self.link.command(machine, *CLI, *words), stdout=said, stderr=said
            )

    def said(self, machine):
        """What a machine's part has printed."""
        return (self.folder / f"said-{machine}").read_text()

    def logs(self):
        """What both have said, and every log."""
        paths = [*self.folder.glob("said-*"), *self.folder.glob("logs-*/*.log")]
        return "\n".join(f"{path.name}: {path.read_text()[-2000:]}" for path in paths)

    def close(self):
        """End both."""
        for run in self.runs.values():
            run.terminate()
        for run in self.runs.values():
            try:
                run.wait(30.0)
            except subprocess.TimeoutExpired:
                run.kill()
                run.wait()
        self.session.close()


@pytest.fixture
def link():
    """Two machines and their cable."""
    made = Link()
    yield made
    made.close()


@pytest.fixture
def two_machines(tmp_path, link):
    """Makes a `TwoMachines`."""
    yield from _closing(lambda *args: TwoMachines(tmp_path, link, *args))


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
