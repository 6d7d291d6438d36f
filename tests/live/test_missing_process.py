"""Time waits for a process that is missing, names it, and goes on with the one that takes its place."""

import os
import signal
import subprocess
import sys
import time
from contextlib import closing

from surefoot.bus.session import Session
from surefoot.tools.diagnosis import why_nothing_moves
from surefoot.tools.stack_watch import StackWatch


def test_time_waits_for_a_process_that_is_missing_or_gone_and_goes_on_with_the_next(stack):
    live = stack(leave_out=("trajopt",))
    live.wait(lambda: "waiting for trajopt to come up" in live.reason("io"))
    assert live.t() == -1.0
    live.begin(b"stand")
    live.wait(lambda: live.t() >= 0.6)
    live.children["mpc"].kill()
    live.children["mpc"].wait()
    live.wait(lambda: "simulated time waits for mpc" in live.reason("io"))
    stopped = live.t()
    time.sleep(0.5)
    assert live.t() == stopped
    live.start("mpc", boot=1)
    live.go_on(0.5)
    assert live.stands()
    assert not any(status.bad_messages for status in live.status.values())


def test_an_io_that_is_stopped_is_named_by_the_run_and_by_a_status_and_then_goes_on(supervised):
    live = supervised("run.command=stand")
    live.wait(lambda: live.t() > 0.3)
    io = live.status["io"].pid
    words = "io has not advanced the clock for", f"is process {io} stopped?"
    with closing(StackWatch(lambda: Session(live.namespace))) as watch:
        watch.listen(2.0)
        os.kill(io, signal.SIGSTOP)

        def told():
            watch.listen(0.2)
            why = why_nothing_moves(watch.picture)
            return all(word in why and word in live.said() for word in words)

        live.wait(told)
        assert watch.ended == "" and not watch.healthy
        status = [sys.executable, "-P", "-m", "surefoot.tools.cli", "status", "--namespace", live.namespace]
        asked = subprocess.run(status, capture_output=True, text=True)
        assert asked.returncode == 2 and f"process {io} holds the bus" in asked.stderr, asked.stderr
        os.kill(io, signal.SIGCONT)
        live.go_on(0.3)
        watch.listen(1.0)
        assert "has not advanced the clock" not in why_nothing_moves(watch.picture)
    assert live.stands() and not any(status.boot for status in live.status.values())
