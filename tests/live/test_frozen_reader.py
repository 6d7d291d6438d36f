"""A reader that takes no messages, a display that was stopped: the run goes on without it."""

import signal
import subprocess
import sys

import pytest
from live_bytes import assert_same_bytes_as_far_as_heard

READER = """
import sys, time
from surefoot.bus.session import Session

heard = 0
def hear(key, payload):
    global heard
    heard += len(payload)

session = Session(sys.argv[1])
session.subscribe("**", hear)
print("listens", flush=True)
while sys.stdin.readline():
    before = heard
    while heard == before:
        time.sleep(0.05)
    print("hears", flush=True)
session.close()
"""


def test_simulated_time_goes_on_without_a_reader_that_is_stopped_and_it_hears_again(stack):
    live = stack(("run.vision=true",), leave_out=("trajopt",))
    live.begin(b"forward")
    pipe = subprocess.PIPE
    command = [sys.executable, "-P", "-c", READER, live.namespace]
    reader = subprocess.Popen(command, stdin=pipe, stdout=pipe, text=True)
    live.children["reader"] = reader
    assert reader.stdout.readline() == "listens\n"
    live.wait(lambda: live.t() >= 0.2)
    reader.send_signal(signal.SIGSTOP)
    try:
        live.go_on(3.0)  # far more than the queues to it hold
    except AssertionError:
        # Zenoh 1.10.2 panicked once when it closed the link: the hub is gone, whatever ours does.
        if "zenoh::net::routing" in (live.config.parent / "log").read_text():
            pytest.xfail("Zenoh's router panicked when it closed the link to the reader")
        raise
    reader.send_signal(signal.SIGCONT)
    assert reader.communicate("\n", timeout=60.0) == ("hears\n", None)
    live.stand_still()
    assert_same_bytes_as_far_as_heard(live, live.t() - 0.5)
    assert not any(status.bad_messages for status in live.status.values())
