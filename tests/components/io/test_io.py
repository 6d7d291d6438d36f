"""The io component: sensors out, gated commands in, and never the truth to a controller."""

from dataclasses import replace
from typing import get_args, get_type_hints

import numpy as np
import pytest

from surefoot.bus.messages import JointCommand, OperatorCommand
from surefoot.components.component import Inbox, Outbox
from surefoot.components.io.io import BACKENDS, Io
from surefoot.config.deployment import Deployment, Run
from surefoot.config.hw import Hw
from surefoot.config.robot import load_robot


def run(io, cycles, command=None, words=()):
    """What is published in so many cycles; `words` are commanded in the first."""
    published = []
    inbox, outbox = Inbox(io.inputs), Outbox(io.outputs, lambda key, message: published.append((key, message)))
    for word in words:
        inbox.deliver("operator/command", OperatorCommand(valid=True, command=word))
    for cycle in range(cycles):
        t = 0.002 * cycle
        if cycle:
            inbox.clear_new()
        if command is not None:
            inbox.deliver("joint/command", command(t))
        io.step(t, inbox, outbox)
    return published


def hold(t):
    q = np.tile(load_robot("aliengo").nominal.stand_q, 4)
    return JointCommand(t=t, valid=True, q=q, kp=np.full(12, 300.0), kd=np.full(12, 8.0))


def laws_of(io):
    """All that is written to the motors from now on."""
    laws, write = [], io.robot.write
    io.robot.write = lambda law: (laws.append(law), write(law))
    return laws


def test_every_cycle_says_what_the_sensors_and_the_gate_saw():
    published = run(Io(Deployment()), 3, hold)
    assert [key for key, _ in published] == ["hw/state", "sim/truth"] * 3
    state = published[-2][1]
    assert state.t == 0.004 and state.valid and not state.damping and state.foot_force.shape == (0,)


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
    written = laws_of(io)
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


def test_a_cut_takes_the_torque_in_the_cycle_that_it_comes_in_whatever_the_controller_sends():
    io = Io(Deployment())
    laws = laws_of(io)
    run(io, 3, hold, ["cut"])
    assert len(laws) == 3 and not any(law.kp.any() or law.kd.any() or law.tau.any() for law in laws)
    assert "cut" in io.trouble


def test_in_a_dry_run_all_is_computed_and_the_motors_only_damp():
    io = Io(Deployment(hw=Hw(dry_run=True)))
    laws = laws_of(io)
    state = run(io, 3, hold)[-2][1]
    assert not any(law.kp.any() or law.tau.any() for law in laws) and all(law.kd.all() for law in laws)
    assert state.damping and state.gate == io.trouble == "DRY RUN, the motors only damp: the command would pass"
    assert "DRY RUN" in (words := run(Io(Deployment(hw=Hw(dry_run=True))), 1)[0][1].gate)
    assert words.endswith("no command yet")


@pytest.mark.parametrize(("stop", "word"), [("settle", "sit"), ("cut", "cut")])
def test_what_is_held_on_a_remote_is_said_once_and_a_cut_is_made_at_once(stop, word):
    io = Io(Deployment())
    read, laws = io.robot.read, laws_of(io)
    io.robot.read = lambda: replace(read(), stop=stop)
    run(io, 3, hold)
    assert io.said == [f"{word}: buttons of the remote"]
    assert all(law.kd.any() for law in laws) == (stop == "settle")


def test_a_reading_that_is_not_finite_is_held_over_then_damped_and_never_published():
    io, count = Io(Deployment()), iter(range(50))
    read = io.robot.read
    io.robot.read = lambda: replace(read(), q=np.full(12, np.nan)) if 10 <= next(count) < 40 else read()
    laws, published = laws_of(io), [message for key, message in run(io, 50, hold) if key == "hw/state"]
    assert len(published) == 20
    driven = [bool(law.kp.any()) for law in laws]
    held = round(Deployment().hw.gate.hold_s / 0.002)
    assert all(driven[: 10 + held - 1]) and not any(driven[10 + held + 1 : 40])
