"""The simulated robot stands on its feet, delays its commands and repeats itself."""

import dataclasses

import numpy as np
import pytest

from surefoot.config.deployment import Deployment
from surefoot.config.hw import Hw
from surefoot.config.robot import GRAVITY, load_robot
from surefoot.hw.mujoco.backend import MujocoRobot
from surefoot.hw.robot_interface import MotorLaw, damping_law

ROBOT = load_robot("aliengo")
STAND_Q = np.tile(ROBOT.nominal.stand_q, 4)


def robot(**settings):
    return MujocoRobot(Deployment(hw=Hw(**settings)))


def stiff(q=STAND_Q):
    one = np.ones(12)
    return MotorLaw(q=q, dq=0.0 * one, kp=300.0 * one, kd=8.0 * one, tau=0.0 * one)


def run(machine, cycles, law):
    for _ in range(cycles):
        machine.write(law)
        machine.advance()
    return machine.truth()


def test_it_stands_and_the_ground_carries_its_weight():
    machine = robot()
    truth = run(machine, 1000, stiff())
    weight = machine.model.body_mass.sum() * GRAVITY
    np.testing.assert_allclose(truth.force_W.sum(axis=0), [0.0, 0.0, weight], atol=0.01 * weight)
    assert truth.p_WB[2] > 0.38
    np.testing.assert_allclose(truth.p_WF[:, 2], ROBOT.foot.radius, atol=1e-3)
    assert truth.body_contact == ""


def test_a_cycle_without_a_command_damps():
    machine = robot()
    run(machine, 200, stiff())
    for _ in range(500):
        machine.advance()
    truth = machine.truth()
    assert truth.p_WB[2] < 0.3
    assert np.abs(machine.data.qvel[6:]).max() < 4.0


def test_lying_it_rests_on_its_belly():
    machine = robot(start="lying")
    for _ in range(250):
        machine.advance()
    assert 0.04 < machine.truth().p_WB[2] < 0.12


def test_hung_its_trunk_stays_and_its_legs_sink_into_the_air():
    machine = robot(start="hung")
    before, after = machine.truth(), run(machine, 1000, damping_law(3.0))
    np.testing.assert_allclose(after.p_WB, before.p_WB, atol=1e-3)
    assert np.abs(after.omega_WB_B).max() < 1e-3 and not after.force_W.any()
    assert (after.p_WF[:, 2] > 0.4).all() and np.abs(after.q - STAND_Q).max() > 0.05


@pytest.mark.parametrize("delay_s", [0.0, 0.004])
def test_a_command_acts_after_the_delay(delay_s):
    machine = robot(command_delay_s=delay_s)
    run(machine, 50, stiff())
    law = dataclasses.replace(stiff(), tau=np.full(12, 5.0), kp=np.zeros(12), kd=np.zeros(12))
    seen = []
    for _ in range(6):
        machine.write(law)
        machine.advance()
        seen.append(np.allclose(machine.truth().tau, 5.0))
    assert seen.index(True) == round(delay_s / 0.002)


def test_the_same_seed_repeats_and_another_does_not():
    def trace(seed):
        machine = robot(seed=seed)
        run(machine, 50, stiff())
        sensors = machine.read()
        return np.concatenate([sensors.q, sensors.dq, sensors.tau, sensors.omega_WB_B, sensors.acc_B]).tobytes()

    assert trace(1) == trace(1)
    assert trace(1) != trace(2)


def test_without_noise_the_sensors_tell_the_truth():
    quiet = robot(
        encoder_noise=0, velocity_noise=0, torque_noise=0, gyro_noise=0, gyro_bias=0, acc_noise=0, acc_bias=0
    )
    run(quiet, 1000, stiff())
    sensors = quiet.read()
    np.testing.assert_array_equal(sensors.q, quiet.truth().q)
    np.testing.assert_allclose(sensors.acc_B, [0.0, 0.0, GRAVITY], atol=0.15)
