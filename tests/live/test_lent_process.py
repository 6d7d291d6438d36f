"""A process of a run is debugged by hand: the supervisor leaves it alone, and runs its own again afterwards."""

import os
import signal

STOP_ONCE = """
import sys
from surefoot.components.wbc.wbc import Wbc
from surefoot.tools.cli import main

step = Wbc.step

def stop_once(self, t, inbox, outbox):
    Wbc.step = step
    breakpoint()
    step(self, t, inbox, outbox)

Wbc.step = stop_once
sys.exit(main(sys.argv[1:]))
"""


def test_time_waits_at_a_breakpoint_and_goes_on_after_it_and_after_ctrl_c(supervised):
    live = supervised("run.command=stand")
    live.wait(lambda: live.t() > 0.8)
    child = live.borrow("wbc", "-c", STOP_ONCE)
    live.wait(lambda: f"wbc, which is lent to process {child.pid}" in live.asked()[0]["why"])
    stood = live.t()
    told, code = live.asked()
    assert code == 1 and told["processes"]["wbc"]["lent_to"] == child.pid
    assert told["why"].endswith("at a breakpoint?")
    assert live.t() == stood
    child.stdin.write("p 'seen ' + self.name\ncontinue\n")
    child.stdin.flush()
    live.go_on(0.4)
    live.wait(lambda: live.status["wbc"].pid == child.pid)
    assert live.stands() and live.status["wbc"].boot == 1
    child.terminate()
    said = child.communicate()[0]
    assert "seen wbc" in said and "boot 1; Ctrl-C gives it back" in said and "wbc given back" in said
    live.wait(lambda: live.boot("wbc") == 2)
    live.go_on(0.4)
    assert live.stands()

    other = live.borrow("mpc")
    live.wait(lambda: live.status["mpc"].pid == other.pid)
    live.go_on(0.2)
    other.send_signal(signal.SIGINT)
    assert "mpc given back" in other.communicate()[0]
    live.wait(lambda: live.boot("mpc") == 2)
    live.go_on(0.4)
    told, code = live.asked()
    assert live.stands() and told["processes"]["mpc"]["lent_to"] is None and code == 0
    assert not any(status.bad_messages for status in live.status.values())


def test_a_lent_process_that_is_killed_is_replaced_and_nothing_is_left_of_a_run_that_is(supervised):
    live = supervised("run.command=stand")
    live.wait(lambda: live.t() > 0.2)
    child = live.borrow("mpc")
    live.wait(lambda: "mpc" in live.status and live.status["mpc"].pid == child.pid)
    child.kill()
    live.wait(lambda: live.boot("mpc") == 2)
    live.go_on(0.2)

    child = live.borrow("wbc")
    live.wait(lambda: live.status["wbc"].pid == child.pid)
    pids = live.children()
    assert len(pids) == 7  # six processes and the guardian
    # A stopped process has no thread that could see its parent go.
    os.kill(live.status["fsm"].pid, signal.SIGSTOP)
    live.run.kill()
    live.wait_gone(pids)
    assert "the run is over" in child.communicate()[0]
