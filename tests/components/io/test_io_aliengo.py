"""The io component with the real robot's driver; a robot on 127.0.0.1 answers over real sockets."""

from contextlib import contextmanager
from dataclasses import replace
from time import monotonic

import numpy as np
from udp_robot import UdpRobot, damps, one_state

from surefoot.bus.messages import JointCommand
from surefoot.components.component import Inbox, Outbox
from surefoot.components.io.io import Io
from surefoot.config.aliengo import Aliengo
from surefoot.config.deployment import Deployment, Run
from surefoot.config.hw import Hw
from surefoot.config.robot import load_robot

STAND = np.tile(load_robot("aliengo").nominal.stand_q, 4)


@contextmanager
def io_of(robot, run, kp_max=500.0, **settings):
    """The io of a robot that stands."""
    still = {
        "dq": np.zeros(12),
        "tau": np.zeros(12),
        "omega_WB_B": np.zeros(3),
        "acc_B": np.array([0.0, 0.0, 9.8]),
    }
    robot.state = replace(robot.state, q=STAND, temperature=np.full(12, 30.0), **still)
    wire = {"address": "127.0.0.1", "port": robot.port, "local_port": 0, "first_answer_s": 60.0}
    hw = Hw(backend="aliengo", kp_max=kp_max, aliengo=Aliengo(**wire | settings))
    io = Io(Deployment(run=run, hw=hw))
    try:
        yield io
    finally:
        io.robot.close()


def step(io, t, command=None):
    sent = []
    inbox = Inbox(io.inputs)
    if command is not None:
        inbox.deliver("joint/command", command)
    io.step(t, inbox, Outbox(io.outputs, lambda key, message: sent.append((key, message))))
    ((key, state),) = sent
    assert key == "hw/state" and state.valid
    return state


def test_a_state_has_the_time_at_which_it_was_measured():
    begin = monotonic()
    run = Run(clock="monotonic", epoch_s=begin)
    with UdpRobot() as robot, io_of(robot, run, stale_s=1.0, tick_unit="us") as io:
        state = step(io, 100.0)
        measured = io.robot.newest.t
        assert 0.0 <= state.t <= measured - begin < 60.0
        np.testing.assert_allclose(state.q, robot.state.q, atol=1e-6)
        np.testing.assert_array_equal(state.foot_force, robot.state.foot_force)


def test_with_an_emulator_that_waits_a_state_has_the_time_of_its_step_and_costs_one_packet():
    with UdpRobot() as robot, io_of(robot, Run(), exchange="cycle") as io:
        assert [step(io, 0.002 * n).t for n in range(5)] == [0.002 * n for n in range(5)]
        assert len(robot.commands) == io.robot.statistics.commands == 6 and robot.tick == 12000
        assert all(damps(command) for command in robot.commands)


def test_the_gate_and_the_link_both_say_what_is_amiss():
    def damaged_first(robot):
        answer = one_state(robot)[0]
        return [answer[:-1] + bytes([answer[-1] ^ 1]), answer]

    with UdpRobot(answer=damaged_first) as robot, io_of(robot, Run(), exchange="cycle") as io:
        step(io, 0.0)
        assert io.trouble.startswith("no command yet; checksum of a G1 state packet = ")


def test_what_the_packet_cannot_hold_is_said_too():
    command = JointCommand(t=0.0, valid=True, q=STAND, kp=np.full(12, 1500.0), kd=np.ones(12))
    with UdpRobot() as robot, io_of(robot, Run(), kp_max=2000.0, exchange="cycle") as io:
        step(io, 0.0, command)
        assert "law.kp of FR_hip = 1500 does not fit the packet: 1023.97 is sent" in io.trouble


def test_a_robot_that_is_too_hot_to_go_on_is_damped():
    with UdpRobot() as robot, io_of(robot, Run(), exchange="cycle") as io:
        step(io, 0.0)
        robot.state = replace(robot.state, temperature=np.full(12, 81.0))
        step(io, 0.002)
        assert "motor of FL_hip has 81 deg C, limit 80" in step(io, 0.004).gate


def test_when_it_ends_the_robot_is_damped_and_the_link_closed():
    with UdpRobot() as robot, io_of(robot, Run(), exchange="cycle") as io:
        step(io, 0.0)
        assert io.deactivate(0.002, Inbox(io.inputs), Outbox(io.outputs, lambda key, message: None))
        ended = len(robot.commands)
        io.robot.close()
    assert ended > 3 + 10 and len(robot.commands) == ended  # one may get lost, and the robot may hold the last
    assert all(damps(command) for command in robot.commands)


def test_a_state_that_an_emulated_link_has_held_up_is_dated_back():
    def every_second(robot):
        robot.tick += 2000
        return [robot.packet()] if len(robot.commands) % 2 else []

    with UdpRobot(answer=every_second) as robot, io_of(robot, Run(), exchange="cycle", tick_unit="us") as io:
        told = [step(io, 0.002 * n).t for n in range(6)]
    np.testing.assert_allclose(told, [0.0, 0.0, 0.004, 0.004, 0.008, 0.008], atol=1e-12)
