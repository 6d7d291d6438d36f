"""`surefoot run`: restarts on request and after a crash, ends in order, leaves nothing behind."""

import os
import signal

import pytest


def test_every_process_but_io_is_restarted_while_the_robot_stands(supervised):
    live = supervised("run.command=stand")
    live.wait(lambda: live.t() > 1.0)
    for name in ("estimator", "wbc", "mpc", "trajopt", "fsm"):
        live.command("restart", name)
        live.wait(lambda name=name: name in live.status and live.status[name].boot == 1)
        live.go_on(0.6)
        assert live.stands(), name
    assert "fsm has lost its place and stands the robot" in live.said()
    assert not any(status.bad_messages for status in live.status.values())


def test_a_controller_is_restarted_while_a_foot_is_in_the_air(supervised):
    live = supervised("run.command=forward")
    live.wait(lambda: live.t() > 2.0 and live.last("fsm/reference").state == "DETECT_CONTACT")
    for name in ("mpc", "wbc"):
        live.command("restart", name)
        live.wait(lambda name=name: live.status[name].boot == 1)
    live.go_on(0.6)
    assert live.stands()


def test_a_process_that_crashes_is_restarted_three_times_and_then_ends_the_run(supervised):
    live = supervised("run.command=stand")
    live.wait(lambda: live.t() > 0.3)
    for boot in range(4):
        live.wait(lambda boot=boot: live.status["wbc"].boot == boot and live.status["wbc"].steps > 0)
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


def test_in_real_time_a_process_that_crashes_ends_the_run(supervised):
    live = supervised("run.clock=monotonic", "mpc.profile=light", 'run.command=""')
    live.pids()
    live.wait(lambda: live.status["mpc"].steps > 0 and live.status["io"].steps > 0)
    os.kill(live.status["mpc"].pid, signal.SIGKILL)
    live.wait_end()
    assert live.run.returncode == 1 and "mpc ended with signal 9" in live.said()
