"""What runs on the bus is in the file: all of it, and all but the last second when the recorder is killed."""

import os
import resource
import signal
import subprocess
import sys
import time

import pytest

from surefoot.bus.topics import PROCESSES
from surefoot.tools.recording.clip import REMEMBER
from surefoot.tools.recording.contents import Contents
from surefoot.tools.recording.replay import replay

RECORD = [sys.executable, "-P", "-m", "surefoot.tools.cli", "record"]


class Recorder:
    """`surefoot record` on a stack."""

    def __init__(self, live, folder, name="out", bytes_most=None):
        self.path, output = folder / f"{name}.mcap", folder / f"{name}.log"

        def limit():
            if bytes_most is not None:
                resource.setrlimit(resource.RLIMIT_FSIZE, (bytes_most, bytes_most))

        with output.open("wb") as log:
            parent = str(os.getpid())  # as one beside its run it has patience with a busy machine
            call = [*RECORD, str(self.path), "--namespace", live.namespace, "--parent", parent]
            self.process = subprocess.Popen(call, stdout=log, stderr=log, preexec_fn=limit)
        self.said = output.read_text
        live.wait(lambda: "recording" in self.said())
        live.wait(lambda: self.path.stat().st_size > 1_000)

    def end(self):
        """Ctrl-C; its exit code."""
        self.process.send_signal(signal.SIGINT)
        return self.process.wait(60.0)


@pytest.fixture
def recorder(tmp_path):
    """Makes a `Recorder`."""
    made = []

    def make(live, **settings):
        made.append(Recorder(live, tmp_path, **settings))
        return made[-1]

    yield make
    for each in made:
        each.process.kill()
        each.process.wait()


def end_stack(live):
    """End the processes in the supervisor's order."""
    for name in reversed(PROCESSES):
        live.children[name].terminate()
        live.children[name].wait(20.0)


def test_all_that_was_published_is_recorded_and_can_be_replayed(stack, recorder):
    live = stack(leave_out=("trajopt",))
    live.wait(lambda: "io" in live.status)
    taken = recorder(live)
    live.begin(b"forward")
    live.wait(lambda: live.t() >= 1.9)
    end_stack(live)
    assert taken.process.wait(60.0) == 0, taken.said()
    contents = Contents(taken.path)
    assert contents.gaps == []
    heard = {key: len(payloads) for key, payloads in live.heard.items() if payloads}
    recorded = {key: topic.messages for key, topic in contents.topics.items() if not key.startswith("status/")}
    assert recorded == heard
    assert {f"status/{name}" for name in PROCESSES} <= contents.topics.keys()
    result = replay(taken.path, REMEMBER)
    told = {key: topic.first for key, topic in result.comparison.topics.items() if topic.first}
    assert told == {} and not any(result.left_out.values()), result.notes
    assert result.steps["wbc"] > 400


def test_a_recorder_that_comes_late_and_stops_early_is_whole_and_a_killed_process_takes_its_last_moment(
    stack, recorder
):
    live = stack(leave_out=("trajopt",))
    live.begin(b"stand")
    live.wait(lambda: live.t() > 0.5)
    taken = recorder(live)
    live.go_on(0.7)
    taken.process.send_signal(signal.SIGSTOP)  # its queue overflows meanwhile
    time.sleep(1.0)
    taken.process.send_signal(signal.SIGCONT)
    live.go_on(1.0)
    assert taken.end() == 0, taken.said()
    contents = Contents(taken.path)
    assert [gap for gap in contents.gaps if "has no end" not in gap] == []
    assert contents.topics["hw/state"].messages > 700
    result = replay(taken.path, REMEMBER)
    assert result.comparison.equal, {key: topic.first for key, topic in result.comparison.topics.items()}

    taken = recorder(live, name="killed")
    live.go_on(0.5)
    live.children["wbc"].kill()
    live.children["wbc"].wait()
    live.start("wbc", boot=1)
    live.go_on(1.2)
    assert taken.end() == 0, taken.said()
    contents = Contents(taken.path)
    assert contents.processes["wbc"].restarts == 1
    result = replay(taken.path, ("wbc", "estimator"))
    assert all(topic.differing == 0 for topic in result.comparison.topics.values())
    assert result.steps["wbc"] > 200
    assert live.stands()


def test_of_two_recorders_one_is_killed_and_one_finds_the_disk_full_and_the_run_goes_on(stack, recorder):
    live = stack(leave_out=("trajopt",))
    live.begin(b"stand")
    live.wait(lambda: live.t() > 0.2)
    full = recorder(live, name="full", bytes_most=1_000_000)
    taken = recorder(live)
    live.go_on(1.5)
    taken.process.kill()
    killed = live.t()
    taken.process.wait()
    contents = Contents(taken.path)
    assert "incomplete" in contents.gaps[0]
    begun = time.monotonic()
    live.go_on(0.5)
    pace = 0.5 / (time.monotonic() - begun)  # seconds of the run for each on the wall
    assert contents.topics["hw/state"].last_t > killed - max(pace, 1.0)
    assert not [gap for gap in contents.gaps if "messages are missing" in gap]
    live.wait(lambda: full.process.poll() is not None)
    assert full.process.returncode == 1
    assert "recording ended" in full.said() and "the run goes on without it" in full.said()
    assert sum(topic.messages for topic in Contents(full.path).topics.values()) > 10
    live.go_on(0.1)
    assert live.stands()
