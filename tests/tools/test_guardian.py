"""Whatever becomes of a supervisor, none of its processes is left: real ones, stopped, deaf or well-behaved."""

import os
import signal
import subprocess
import sys

import pytest

from surefoot.tools.guardian import Guardian
from surefoot.tools.other_process import OtherProcess

# A supervisor with three children: one that is deaf, one that is stopped, and one that ends when it is continued.
SUPERVISOR = """
import os, signal, subprocess, sys
from pathlib import Path
from surefoot.tools.guardian import Guardian

CHILDREN = {
    "deaf": "signal.signal(signal.SIGTERM, signal.SIG_IGN)",
    "stopped": "pass",
    "good": "signal.signal(signal.SIGCONT, lambda *_: os._exit(0))",
}
guardian = Guardian(Path(sys.argv[1]), 0.3)
for name, code in CHILDREN.items():
    code = f"import os, signal, time; {code}; print(flush=True); time.sleep(600)"
    child = subprocess.Popen([sys.executable, "-c", code], stdout=subprocess.PIPE, start_new_session=True)
    child.stdout.readline()
    guardian.watch(child.pid, name)
    print(child.pid, flush=True)
    if name != "deaf":
        child.send_signal(signal.SIGSTOP)
print(guardian._popen.pid, flush=True)
signal.pause()
"""


@pytest.fixture
def log(tmp_path):
    return tmp_path / "supervisor.log"


def test_after_a_kill_the_stopped_and_the_deaf_are_ended_and_the_others_end_by_themselves(log):
    supervisor = subprocess.Popen([sys.executable, "-P", "-c", SUPERVISOR, str(log)], stdout=subprocess.PIPE)
    left = [OtherProcess(int(supervisor.stdout.readline())) for _ in range(4)]
    supervisor.kill()
    supervisor.wait()
    assert all(each.wait(60.0) for each in left)  # the children, then the guardian itself
    said = log.read_text()
    assert "deaf did not end in 0.3 s: killed" in said and "stopped did not end" in said
    assert "good" not in said


def test_a_run_that_ends_in_order_needs_no_guardian(log):
    guardian = Guardian(log, 600.0)
    child = subprocess.Popen([sys.executable, "-c", "import time; time.sleep(600)"])
    guardian.watch(child.pid, "mpc")
    child.kill()
    child.wait()
    guardian.close()  # waits for it
    assert log.read_text() == ""


def test_a_process_that_took_anothers_place_is_the_one_that_is_watched(log):
    guardian = Guardian(log, 0.2)
    first, second = (subprocess.Popen([sys.executable, "-c", "import time; time.sleep(600)"]) for _ in range(2))
    guardian.watch(first.pid, "mpc")
    first.kill()
    first.wait()
    guardian.watch(second.pid, "mpc")
    guardian.close()
    assert second.wait() == -signal.SIGKILL


def test_a_guardian_that_somebody_killed_does_not_end_the_run(log):
    guardian = Guardian(log)
    guardian._popen.kill()
    guardian._popen.wait()
    guardian.watch(os.getpid(), "mpc")
    guardian.close()


def test_another_process_is_held_by_more_than_its_number():
    child = subprocess.Popen([sys.executable, "-c", "import time; time.sleep(600)"])
    other = OtherProcess(child.pid)
    assert not other.gone
    other.signal(signal.SIGKILL)
    assert other.wait(60.0) and other.gone  # though nobody has asked for its exit code yet
    child.wait()
    other.signal(signal.SIGKILL)
    other.close()
    with pytest.raises(ProcessLookupError):
        OtherProcess(child.pid)
