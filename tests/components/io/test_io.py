"""The io component: sensors out, gated commands in, and never the truth to a controller."""

from dataclasses import replace
from typing import get_args, get_type_hints

import numpy as np
import pytest

from surefoot.bus.messages import JointCommand
from surefoot.components.component import Inbox, Outbox
from surefoot.components.io.io import BACKENDS, Io
from surefoot.config.deployment import Deployment, Run
from surefoot.config.hw import Hw
from surefoot.config.robot import load_robot


def run(io, cycles, command=None):
    published = []
    inbox, outbox = Inbox(io.inputs), Outbox(io.outputs, lambda key, message: published.append((key, message)))
    for cycle in range(cycles):
        t = 0.002 * cycle
        if command is not None:
            inbox.deliver("joint/command", command(t))
        io.step(t, inbox, outbox)
    return published


def hold(t):
    q = np.tile(load_robot("aliengo").nominal.stand_q, 4)
    return JointCommand(t=t, valid=True, q=q, kp=np.full(12, 300.0), kd=np.full(12, 8.0))


def test_every_cycle_says_what_the_sensors_and_the_gate_saw():
    published = run(Io(Deployment()), 3, hold)
    assert [key for key, _ in published] == ["hw/state", "sim/truth"] * 3
    state = published[-2][1]
    assert state.t == 0.004 and state.valid and not state.damping


def test_without_a_controller_the_robot_damps_and_says_why():
    io = Io(Deployment())
    state = run(io, 5)[-2][1]
    assert state.damping and state.gate == io.trouble == "no command yet"
    run(io, 5, hold)
    assert io.trouble == ""


def test_a_malformed_command_damps_that_cycle():
    def broken(t):
        command = hold(t)
        return JointCommand(t=t, valid=True, q=command.q, kp=np.full(12, np.nan), kd=command.kd)

    state = run(Io(Deployment()), 5, broken)[-2][1]
    assert state.damping and "command.kp of FL_hip is not finite" in state.gate


def test_the_backend_is_the_deployments_choice(monkeypatch):
    assert set(BACKENDS) == set(get_args(get_type_hints(Hw)["backend"]))
    monkeypatch.setitem(BACKENDS, "other", lambda deployment: deployment.hw.seed)
    assert Io(Deployment(hw=Hw(backend="other", seed=5))).robot == 5


def test_when_it_ends_the_robot_is_damped_and_closed():
    io = Io(Deployment())
    run(io, 50, hold)
    closed = []
    io.robot.close = lambda: closed.append(io.robot._laws[-1][1])
    assert io.deactivate(0.1, Inbox(io.inputs), Outbox(io.outputs, lambda key, message: None))
    (last,) = closed
    assert not last.kp.any() and not last.tau.any() and (last.kd == Deployment().hw.damping_kd).all()


def test_the_gate_sees_what_the_sensors_say_and_how_old_that_is():
    io = Io(Deployment())
    read = io.robot.read
    run(io, 2, hold)
    io.robot.read = lambda: replace(read(), temperature=np.full(12, 90.0))
    state = run(io, 1, hold)[-2][1]
    assert state.damping and state.gate.startswith("stopped (motor of FL_hip has 90 deg C, limit 80: let it cool)")
    io.robot.read = lambda: replace(read(), t=-0.04)
    assert "measurements are 40.0 ms old, limit 30 ms" in run(io, 1, hold)[-2][1].gate


def test_a_robot_whose_torque_is_cut_is_left_without():
    io = Io(Deployment())
    run(io, 2, hold)
    io._gate.cut("button A")
    assert run(io, 1, hold)[-2][1].gate.startswith("torque is cut (button A)")
    closed = []
    io.robot.close = lambda: closed.append(io.robot._laws[-1][1])
    io.deactivate(0.1, Inbox(io.inputs), Outbox(io.outputs, lambda key, message: None))
    (last,) = closed
    assert not last.kp.any() and not last.kd.any() and not last.tau.any()


def test_the_cycles_missed_in_a_stall_are_made_up_and_none_with_a_command_too_old():
    io = Io(Deployment())
    written = []
    write = io.robot.write
    io.robot.write = lambda law: (written.append(law), write(law))
    inbox, outbox = Inbox(io.inputs), Outbox(io.outputs, lambda key, message: None)
    inbox.deliver("joint/command", hold(0.0))
    io.step(0.0, inbox, outbox)
    io.step(0.040, inbox, outbox)
    assert len(written) == 21 and all(law.kp.any() for law in written)
    io.step(0.400, inbox, outbox)
    assert io.robot.t == pytest.approx(0.402) and "400.0 ms old" in io.trouble
    assert len(written) == 201 and not any(law.kp.any() for law in written[21:])


def test_with_vision_an_image_has_the_time_of_its_cycles_state_and_blind_there_is_none():
    published = run(Io(Deployment(run=Run(vision=True))), 70)
    frames = [message for key, message in published if key == "hw/depth"]
    states = {message.t for key, message in published if key == "hw/state"}
    assert [frame.t for frame in frames] == [0.0, 0.068, 0.134] and {frame.t for frame in frames} <= states
    settings = Deployment().hw.depth
    for frame in frames:
        assert frame.valid and frame.depth_m.shape == (settings.rows, settings.columns)
        assert frame.depth_m.dtype == np.float32 and frame.depth_m.max() > 0.3
        np.testing.assert_array_equal(frame.fov, [settings.fov_x, settings.fov_y])
    assert not [key for key, _ in run(Io(Deployment()), 70) if key == "hw/depth"]
