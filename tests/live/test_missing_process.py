"""Time waits for a process that is missing, names it, and goes on with the one that takes its place."""

import time


def test_a_missing_process_is_named(stack):
    live = stack(leave_out=("trajopt",))
    live.wait(lambda: "waiting for trajopt to come up" in live.reason("io"))
    assert live.t() == -1.0


def test_time_waits_for_a_process_that_is_gone_and_goes_on_with_the_next(stack):
    live = stack(leave_out=("trajopt",))
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
