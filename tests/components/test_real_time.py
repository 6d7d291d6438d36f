"""Real-time priority: every thread has it where it may; elsewhere the words say what would permit it."""

import os
import subprocess
import sys

import pytest

from surefoot.bus.topics import processes
from surefoot.components import real_time
from surefoot.components.real_time import refusal

needs_permission = pytest.mark.skipif(bool(refusal(40)), reason="this user may ask for no real-time priority")
needs_root = pytest.mark.skipif(os.getuid() != 0, reason="only root can become another user")


def said(program, **how):
    """What a program that has imported `real_time` prints."""
    lines = f"import os, threading, time\nfrom surefoot.components import real_time\n{program}"
    done = subprocess.run([sys.executable, "-P", "-c", lines], capture_output=True, text=True, check=True, **how)
    return done.stdout.split("\n")[0]


@needs_permission
def test_threads_made_before_and_after_have_the_priority():
    wait = "threading.Thread(target=time.sleep, args=(5,), daemon=True).start()\n"
    tell = "print({os.sched_getscheduler(int(t)) for t in os.listdir('/proc/self/task')} == {os.SCHED_FIFO}, "
    assert said(f"{wait}real_time.claim(40, 0)\n{wait}{tell}len(os.listdir('/proc/self/task')))") == "True 3"


@needs_permission
@pytest.mark.parametrize("core", [0, 1, 255])
def test_threads_made_before_and_after_keep_to_one_core(core):
    wait = "threading.Thread(target=time.sleep, args=(5,), daemon=True).start()\n"
    tell = "print({core for t in os.listdir('/proc/self/task') for core in os.sched_getaffinity(int(t))})"
    cores = real_time._cores(os.sched_getaffinity(0))
    assert said(f"{wait}real_time.claim(40, {core})\n{wait}{tell}") == f"{{{cores[min(core, len(cores) - 1)]}}}"


@needs_permission
def test_to_ask_whether_it_is_permitted_changes_nothing():
    before = os.sched_getscheduler(0), os.sched_getparam(0).sched_priority
    assert refusal(40) == ""
    assert (os.sched_getscheduler(0), os.sched_getparam(0).sched_priority) == before


@needs_root
def test_who_may_not_reads_what_would_permit_it():
    words = said("os.setuid(65534)\nprint(real_time.claim(40, 0), real_time.refusal(40))")
    assert words.startswith("False no real-time priority 40 (run.realtime_priority)")
    assert "rtprio 80" in words


def test_the_nearer_to_the_motors_the_more_urgent():
    urgency = {name: process.urgency for name, process in processes().items()}
    assert urgency["io"] > urgency["estimator"] > urgency["wbc"] > urgency["fsm"] > urgency["mpc"] > 0
    assert urgency["trajopt"] == urgency["elevation_map"] == 0


def test_what_feeds_one_another_in_every_cycle_shares_a_core():
    core = {name: process.core for name, process in processes().items() if process.urgency}
    assert core == {"io": 0, "estimator": 0, "wbc": 1, "fsm": 1, "mpc": 2}


@pytest.mark.parametrize(
    ("siblings", "order"),
    [
        (["0-1", "0-1", "2-3", "2-3"], [0, 2, 1, 3]),
        (["0,2", "1,3", "0,2", "1,3"], [0, 1, 2, 3]),
        (["0-1", "0-1"], [0, 1]),
        ([None, None, None], [0, 1, 2]),
    ],
)
def test_threads_of_one_core_are_not_taken_for_two_cores(siblings, order, tmp_path, monkeypatch):
    for thread, text in enumerate(siblings):
        if text is not None:
            (tmp_path / f"cpu{thread}/topology").mkdir(parents=True)
            (tmp_path / f"cpu{thread}/topology/thread_siblings_list").write_text(text + "\n")
    monkeypatch.setattr(real_time, "_TOPOLOGY", str(tmp_path))
    assert real_time._cores(set(range(len(siblings)))) == order
    assert real_time._cores({1}) == [1]


def test_who_gives_way_takes_those_along_that_come_later_and_no_others():
    wait = "threading.Thread(target=time.sleep, args=(5,), daemon=True).start()\n"
    tell = "tasks = sorted(map(int, os.listdir('/proc/self/task')))\n"
    tell += "print(*(os.sched_getscheduler(task) == os.SCHED_IDLE for task in tasks))"
    assert said(f"{wait}real_time.give_way()\n{wait}{tell}") == "True False True"
