"""`surefoot run`: restarts on request and after a crash, ends in order, leaves nothing behind."""

import os
import signal
from contextlib import closing

import pytest

from surefoot.bus.codec import decode
from surefoot.bus.session import Session
from surefoot.bus.topics import TOPICS
from surefoot.tools.stack_watch import StackWatch


def test_every_process_but_io_is_restarted_while_the_robot_stands(supervised):
    live = supervised("run.command=stand")
    live.wait(lambda: live.t() > 1.0)
    for name in ("estimator", "wbc", "mpc", "trajopt", "fsm"):
        live.command("restart", name)
        live.wait(lambda name=name: live.boot(name) == 1)
        live.go_on(0.6)
        assert live.stands(), name
    assert not any(status.bad_messages for status in live.status.values())


def test_a_process_that_crashes_is_restarted_three_times_and_then_ends_the_run(supervised):
    live = supervised("run.command=stand")
    live.wait(lambda: live.t() > 0.3)
    for boot in range(4):
        live.wait(lambda boot=boot: live.boot("wbc") == boot and live.status["wbc"].steps > 0)
        os.kill(live.status["wbc"].pid, signal.SIGKILL)
    live.wait_end()
    said = live.said()
    assert live.run.returncode == 1
    assert "wbc ended with signal 9, see" in said and "restarted, 3 of 3" in said
    assert "it had been restarted 3 times" in said and "wbc.log" in said
    assert "restarted, 3 of 3" in live.log("supervisor")


@pytest.mark.parametrize(
    "how", [signal.SIGTERM, signal.SIGINT, signal.SIGHUP, signal.SIGKILL], ids=lambda how: how.name
)
def test_no_process_is_left_behind(supervised, how):
    live = supervised("run.command=stand")
    pids = live.pids()
    live.run.send_signal(how)
    live.wait_end()
    live.wait_gone(pids)
    if how != signal.SIGKILL:
        assert live.run.returncode == 0 and "ended by the user" in live.said()


def test_in_real_time_a_successor_takes_over_without_a_trace(supervised):
    """Only their statuses tell the two apart; one that comes too late on a busy machine tries again."""
    live = supervised("run.clock=monotonic", "run.speed=0.2", 'run.command=""')
    live.pids()
    live.wait(lambda: "fsm" in live.status and live.status["fsm"].life == "RUN")
    for name, key in (("fsm", "fsm/reference"), ("wbc", "joint/command")):
        live.wait(lambda name=name: live.status[name].life == "RUN")
        for _ in range(6):
            pid, boot = live.status[name].pid, live.last(key).boot
            live.command("restart", name)
            live.wait(lambda name=name, pid=pid: live.status[name].pid != pid)
            if live.last(key).boot == boot:
                break
        assert live.last(key).boot == boot, live.said()
        live.go_on(0.2)
        with live.lock:
            messages = [decode(TOPICS[key].message, payload) for payload in live.heard[key]]
        numbers = [(message.boot, message.seq) for message in messages]
        assert numbers == sorted(set(numbers))
        assert f"{name} restarted on request" in live.log("supervisor")
    with closing(StackWatch(lambda: Session(live.namespace))) as watch:
        watch.listen(3.0)
        for name in ("fsm", "wbc"):  # it is seen again, as a process that was restarted
            seen = watch.picture.processes[name]
            assert seen.restarts > 0 and seen.status.pid == live.status[name].pid
    assert not any(live.status[name].bad_messages for name in ("estimator", "wbc", "mpc", "io"))


def test_in_real_time_a_process_that_crashes_ends_the_run(supervised):
    live = supervised("run.clock=monotonic", 'run.command=""')
    live.pids()
    live.wait(lambda: live.status["mpc"].steps > 0 and live.status["io"].steps > 0)
    os.kill(live.status["mpc"].pid, signal.SIGKILL)
    live.wait_end()
    assert live.run.returncode == 1 and "mpc ended with signal 9" in live.said()
