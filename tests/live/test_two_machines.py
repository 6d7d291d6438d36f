"""A run over two machines with a cable between them that is pulled and plugged in again."""

import subprocess
import sys
import time

import numpy as np
import pytest
from live_bytes import assert_same_bytes_as_far_as_heard

from surefoot.bus.codec import decode
from surefoot.bus.topics import TOPICS

CLI = [sys.executable, "-P", "-m", "surefoot.tools.cli"]
UNTIL_S = 1.6
HOSTS = {"robot": ("io", "estimator", "wbc"), "laptop": ("mpc", "fsm", "trajopt", "elevation_map")}


def test_simulated_time_waits_for_a_link_that_is_down_and_goes_on_with_the_same_bytes(two_machines):
    live = two_machines(HOSTS, "run.command=forward")
    for t in (0.3, 0.9):
        live.wait(lambda t=t: live.t() >= t)
        live.link.down()
        live.wait(lambda: "simulated time waits for" in live.reason("io"))
        stopped = live.t()
        time.sleep(3.0)  # longer than a session lives without its other side
        assert live.t() == stopped
        live.link.up()
        live.wait(lambda stopped=stopped: live.t() > stopped)
    live.wait(lambda: live.t() >= UNTIL_S)
    assert_same_bytes_as_far_as_heard(live, UNTIL_S)
    assert live.stands()
    assert "Traceback" not in live.logs()
    ill = {name: status for name, status in live.status.items() if status.bad_messages or status.boot}
    assert not ill, live.logs()


def test_over_a_link_that_loses_every_fifth_packet_the_bytes_are_the_same(link, two_machines):
    link.spoil(20, 10)
    live = two_machines(HOSTS, "run.command=forward")
    live.wait(lambda: live.t() >= 0.2)
    assert_same_bytes_as_far_as_heard(live, 0.2)
    assert all(link.lost(machine) > 20 for machine in live.runs)


def test_in_real_time_the_robot_is_safe_without_the_link_and_goes_on_with_it(link, two_machines):
    hosts = {"robot": ("io", "estimator", "wbc", "fsm"), "laptop": ("mpc", "trajopt", "elevation_map")}
    live = two_machines(hosts, "run.clock=monotonic", "run.speed=0.2", "run.command=stand")

    def wait(holds):
        """Until `holds()`; a machine so busy that the robot damps itself meanwhile is no test of the link."""
        live.wait(lambda: holds() or live.runs["robot"].poll() is not None)
        if live.runs["robot"].poll() is not None:
            assert "state/estimate is missing or stale" in live.said("robot"), live.logs()
            assert upright(live)
            pytest.skip("this machine is too busy for real time: the robot damped itself")

    wait(lambda: follows_a_policy(live))
    live.link.down()
    end = live.t() + 1.0
    wait(lambda: live.t() > end)
    assert not follows_a_policy(live)
    live.link.up()
    wait(lambda: follows_a_policy(live) or lowered(live))  # whether it comes back in time is up to the machine

    live.link.down()
    wait(lambda: lowered(live))
    live.link.up()
    policies = len(live.heard["mpc/policy"])
    wait(lambda: len(live.heard["mpc/policy"]) > policies + 20)
    assert lowered(live), "a robot that lies on the ground is not to rise by itself"

    answers = {"sit": "the robot sits down, then it is damped", "stand": "the robot stands up first"}
    for command, state in (("sit", "DAMP"), ("stand", "STAND")):
        try:
            said = live.link.on("laptop", *CLI, "command", command, "--connect", str(live.config))
        except subprocess.CalledProcessError:
            wait(lambda: False)  # it has ended for the reason that `wait` knows, or the test fails there
        assert said == f"told tls/{live.link.address['robot']}:7448: {command}\n{answers[command]}\n"
        wait(lambda state=state: live.last("fsm/reference").state == state)
    wait(lambda: follows_a_policy(live))
    assert upright(live)
    assert "Traceback" not in live.logs()


def upright(live):
    """Whether the robot has never tipped over."""
    with live.lock:
        truth = [decode(TOPICS["sim/truth"].message, payload) for payload in live.heard["sim/truth"]]
    return max(2.0 * np.arccos(min(1.0, abs(each.quat_WB[0]))) for each in truth) < 0.5


def newest_commands(live):
    """What the whole-body controller said in the last 0.1 s, as long as a policy counts as fresh."""
    return live.newest("joint/command", 0.1)


def follows_a_policy(live):
    """Whether the whole-body controller follows the MPC."""
    return any(command.policy_age_s not in (0.0, -1.0) for command in newest_commands(live))


def lowered(live):
    """Whether the base has been lowered for want of a policy, and the joints are damped."""
    return any("has been lowered" in command.solver for command in newest_commands(live))
