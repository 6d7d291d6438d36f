"""`surefoot status` against a real bus on which the processes are only played."""

import json
import os
import threading
import time

import numpy as np
import pytest

from surefoot.bus.codec import encode
from surefoot.bus.messages import MotionReference, ProcessStatus
from surefoot.bus.session import Session
from surefoot.bus.topics import PROCESSES
from surefoot.tools.cli import main
from surefoot.tools.commands.call import deployment_file
from surefoot.tools.stack_watch import StackWatch
from surefoot.tools.supervisor_messages import NOTICE, Notice, Post, pack_notice, unpack_notice


class PlayedStack:
    """A hub that says what seven processes and a supervisor would."""

    def __init__(self, namespace):
        self.namespace, self.reasons, self.ending, self.lent_to = namespace, {}, "", 0
        self.session = Session(namespace, hub=True)
        self._over = threading.Event()
        self._thread = threading.Thread(target=self._play)
        self._thread.start()

    def _play(self):
        count = 0
        while not self._over.wait(0.1):
            count += 1
            t = 0.1 * count
            for name in PROCESSES:
                status = ProcessStatus(
                    t=t, process=name, life="RUN", steps=count, pid=100, reason=self.reasons.get(name, ""),
                    input=("state/estimate",), input_age_s=np.array([0.004]),
                )  # fmt: skip
                self.session.put(f"status/{name}", encode(status))
            self.session.put("fsm/reference", encode(MotionReference(t=t, state="STAND", reason="stood up")))
            posts = {name: Post(lent_to=self.lent_to if name == "wbc" else 0) for name in PROCESSES}
            config = str(deployment_file("planks"))
            self.session.put(
                NOTICE, pack_notice(Notice(7, config, ["hw.seed=3"], posts, ["mpc restarted"], self.ending))
            )

    def close(self):
        self._over.set()
        self._thread.join()
        self.session.close()


@pytest.fixture
def stack(tmp_path):
    played = PlayedStack(f"test-{os.getpid()}-{tmp_path.name}")
    yield played
    if not played._over.is_set():
        played.close()


def test_the_table_for_scripts_says_all_and_its_exit_code_whether_all_is_well(stack, capsys):
    stack.lent_to = 4242
    assert main(["status", "--json", "--namespace", stack.namespace]) == 0
    told = json.loads(capsys.readouterr().out)
    assert told["healthy"] and told["state"] == "STAND" and told["notes"] == ["mpc restarted"]
    assert told["config"].endswith("planks.toml") and "waits for a command" in told["why"]
    assert set(told["processes"]) == set(PROCESSES)
    wbc = told["processes"]["wbc"]
    assert wbc["lent_to"] == 4242 and wbc["life"] == "RUN" and told["processes"]["mpc"]["lent_to"] is None
    assert wbc["inputs"] == [{"topic": "state/estimate", "age_s": 0.004, "stale_after_s": 0.04}]
    stack.reasons["mpc"] = "riccati: node 3"
    assert main(["status", "--json", "--namespace", stack.namespace]) == 1
    told = json.loads(capsys.readouterr().out)
    assert not told["healthy"] and told["processes"]["mpc"]["trouble"] == "riccati: node 3"


def test_without_a_terminal_the_screen_is_printed_once(stack, capsys):
    assert main(["status", "--namespace", stack.namespace]) == 0
    said = capsys.readouterr().out
    assert stack.namespace in said and all(name in said for name in PROCESSES) and "Why nothing moves" in said


def test_a_visit_knows_the_runs_deployment_and_notices_that_the_stack_has_ended(stack):
    watch = StackWatch(lambda: Session(stack.namespace))
    watch.listen(1.0)
    assert watch.healthy and "planks.toml, simulated clock, supervisor 7" in watch.title
    stack.ending = "stopped by command"
    watch.listen(0.5)
    assert not watch.healthy and watch.ended == ""
    stack.close()
    end = time.monotonic() + 60.0
    while not watch.ended and time.monotonic() < end:
        watch.look()
        time.sleep(0.05)
    assert watch.ended == "stopped by command"
    watch.close()


def test_where_no_stack_runs_that_is_an_error_and_no_status(tmp_path, capsys):
    assert main(["status", "--namespace", "nobody-listens-here"]) == 2
    assert "surefoot run" in capsys.readouterr().err


def test_a_notice_keeps_what_it_was_given():
    notice = Notice(7, "/x/flat.toml", ["a=1"], {"mpc": Post(2, 0, "ended", 3.5)}, ["note"], "why")
    assert unpack_notice(pack_notice(notice)) == notice
