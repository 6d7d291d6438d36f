"""Seven processes over Zenoh with simulated time: the same bytes as in one process; restart; bad input."""

import os
import signal
import subprocess
import sys
import threading
import time
from dataclasses import replace

import pytest

from surefoot.bus.codec import decode, encode
from surefoot.bus.errors import BusError
from surefoot.bus.messages import ProcessStatus
from surefoot.bus.session import Session
from surefoot.bus.topics import PROCESSES, TOPICS
from surefoot.components import clock_messages as clock
from surefoot.components.lockstep import Lockstep
from surefoot.config.deployment import Deployment, Run, load_deployment

KEYS = [key for key in TOPICS if not key.startswith("status/")]
UNTIL_S = 1.6  # stands up, plans a stride and begins to shift its base


class Live:
    """The processes of a deployment, started by hand, and all that they published."""

    def __init__(self, tmp_path, name, overrides=(), leave_out=()):
        self.namespace = f"test-{os.getpid()}-{name}"
        config = tmp_path / "live.toml"
        config.write_text('[terrain]\nkind = "flat"\n')
        self.overrides = [f"run.namespace={self.namespace}", *overrides]
        self.config, self.log = config, (tmp_path / "log").open("ab")
        self.deployment = load_deployment(config, self.overrides)
        self.heard = {key: [] for key in KEYS}
        self.status = {}
        self.lock = threading.Lock()
        self.children = {}
        self.start("io")
        self.session = Session(self.namespace)
        for key in KEYS:
            self.session.subscribe(key, self.hear)
        self.session.subscribe("status/*", self.hear_status)
        for process in PROCESSES:
            if process != "io" and process not in leave_out:
                self.start(process)

    def start(self, process):
        settings = [word for override in self.overrides for word in ("--set", override)]
        command = [sys.executable, "-P", "-m", "surefoot.tools.cli", "child", str(self.config), process, *settings]
        self.children[process] = subprocess.Popen(command, stdout=self.log, stderr=self.log)

    def hear(self, key, payload):
        with self.lock:
            self.heard[key].append(payload)

    def hear_status(self, key, payload):
        self.status[key.split("/")[1]] = decode(ProcessStatus, payload)

    def t(self):
        with self.lock:
            states = self.heard["hw/state"]
            return decode(TOPICS["hw/state"].message, states[-1]).t if states else -1.0

    def begin(self, command):
        """Give a command while time still stands at 0, then let the last process come up."""
        self.wait(lambda: "io" in self.status)
        self.session.put(clock.REQUEST, command)
        time.sleep(0.3)
        self.start("trajopt")

    def wait(self, holds, seconds=90.0):
        end = time.monotonic() + seconds
        while not holds():
            assert time.monotonic() < end, f"t = {self.t()}, status {[s.reason for s in self.status.values()]}"
            time.sleep(0.05)

    def close(self):
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


@pytest.fixture
def live(tmp_path, request):
    stacks = []

    def make(*args, **kwargs):
        stacks.append(Live(tmp_path, request.node.name[:20], *args, **kwargs))
        return stacks[-1]

    yield make
    for stack in stacks:
        stack.close()


def local_bytes(deployment, until_s):
    stack = Lockstep(deployment)
    heard = {key: [] for key in KEYS}
    stack.listen(lambda key, message: heard[key].append(encode(message, volatile=False)) if key in heard else None)
    stack.command("forward")
    stack.run(until_s)
    return heard


def test_over_the_bus_and_in_one_process_give_the_same_bytes(live):
    stack = live(leave_out=("trajopt",))
    stack.begin(b"forward")
    stack.wait(lambda: stack.t() >= UNTIL_S)
    expected = local_bytes(stack.deployment, UNTIL_S)
    other = local_bytes(replace(stack.deployment, hw=replace(stack.deployment.hw, seed=1)), 0.1)
    with stack.lock:
        heard = {key: list(payloads) for key, payloads in stack.heard.items()}
    for key in KEYS:
        want = expected[key]
        kind = TOPICS[key].message
        got = [encode(decode(kind, payload), volatile=False) for payload in heard[key][: len(want)]]
        differing = [index for index, pair in enumerate(zip(got, want, strict=True)) if pair[0] != pair[1]]
        assert not differing, f"{key} differs first at message {differing[0]} of {len(want)}"
    assert len(expected["mpc/policy"]) > 50 and expected["trajopt/plan"]
    assert other["hw/state"] != expected["hw/state"][: len(other["hw/state"])]


def test_time_waits_for_a_process_that_is_gone_and_goes_on_with_the_next(live):
    stack = live(leave_out=("trajopt",))
    stack.begin(b"stand")
    stack.wait(lambda: stack.t() >= 0.6)
    stack.children["mpc"].kill()
    stack.children["mpc"].wait()
    stack.wait(lambda: "mpc" in stack.status.get("io", ProcessStatus()).reason)
    stopped = stack.t()
    time.sleep(0.5)
    assert stack.t() == stopped
    stack.start("mpc")
    stack.wait(lambda: stack.t() > stopped + 0.5)
    truth = decode(TOPICS["sim/truth"].message, stack.heard["sim/truth"][-1])
    assert truth.p_WB[2] > 0.37 and truth.body_contact == ""


def test_a_malformed_message_is_counted_dropped_and_changes_nothing(live):
    stack = live(leave_out=("trajopt",))
    stack.begin(b"stand")
    stack.wait(lambda: stack.t() >= 0.3)
    stack.session.put("fsm/reference", b"\xc1 not msgpack")
    stack.wait(
        lambda: all(stack.status.get(name, ProcessStatus()).bad_messages for name in ("mpc", "wbc", "estimator"))
    )
    before = stack.t()
    stack.wait(lambda: stack.t() > before + 0.3)
    assert decode(TOPICS["sim/truth"].message, stack.heard["sim/truth"][-1]).p_WB[2] > 0.37


def test_a_missing_process_is_named(live):
    stack = live(leave_out=("trajopt",))
    stack.wait(lambda: "trajopt" in stack.status.get("io", ProcessStatus()).reason)
    assert stack.t() == -1.0


def test_no_hub_is_a_clear_error():
    with pytest.raises(BusError, match="surefoot run"):
        Session("nobody-listens-here", connect_ms=300)


def test_a_second_hub_of_one_namespace_is_refused(live):
    stack = live(leave_out=tuple(name for name in PROCESSES if name != "io"))
    with pytest.raises(BusError, match=r"already serves"):
        Session(stack.namespace, hub=True)


def test_the_default_run_is_simulated():
    assert Deployment().run == Run() and Run().clock == "simulated"
