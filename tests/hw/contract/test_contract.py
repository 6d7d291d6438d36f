"""What every robot keeps, whatever stands behind the interface; joints in order FL, FR, RL, RR."""

import numpy as np
import pytest
from machines import DAMPING_KD, KINDS, LEGS_UP, machine

from surefoot.config.robot import GRAVITY, JOINT_NAMES, load_robot
from surefoot.hw.errors import HardwareFault
from surefoot.hw.robot_interface import MotorLaw, damping_law

ROBOT = load_robot("aliengo")
ZERO = np.zeros(12)


def law(q=LEGS_UP, kp=100.0, kd=3.0, tau=ZERO):
    return MotorLaw(q=q, dq=ZERO, kp=np.full(12, kp), kd=np.full(12, kd), tau=tau)


@pytest.fixture(params=KINDS)
def robot(request):
    with machine(request.param) as made:
        yield made


def test_sensors_are_finite_and_of_their_shapes(robot):
    sensors = robot.run(1)
    for name, shape in (("q", 12), ("dq", 12), ("tau", 12), ("omega_WB_B", 3), ("acc_B", 3)):
        value = getattr(sensors, name)
        assert value.shape == (shape,) and np.isfinite(value).all(), name
    assert sensors.t is None or np.isfinite(sensors.t)
    assert robot.robot.depth() is None and robot.robot.trouble == ""


def test_each_joint_moves_alone_and_the_way_it_is_pressed(robot):
    rest = robot.run(10, law()).q
    np.testing.assert_allclose(rest, LEGS_UP, atol=0.05)
    for joint, name in enumerate(JOINT_NAMES):
        moved = robot.run(12, law(tau=np.where(np.arange(12) == joint, 6.0, 0.0))).q - rest
        assert moved[joint] > 0.01 and np.argmax(np.abs(moved)) == joint, name
        rest = robot.run(30, law()).q


def test_a_resting_imu_measures_gravity_upwards(robot):
    sensors = robot.run(30, law())
    np.testing.assert_allclose(sensors.acc_B, [0.0, 0.0, GRAVITY], atol=0.5)
    np.testing.assert_allclose(sensors.omega_WB_B, 0.0, atol=0.1)


def test_a_turning_trunk_turns_the_gyroscope_the_same_way(robot):
    robot.run(5, law())
    swung = law(kp=0.0, kd=0.0, tau=np.tile([0.0, -30.0, 0.0], 4))
    rates = [robot.run(1, swung).omega_WB_B[1] for _ in range(12)]
    y = robot.plant.truth().quat_WB[2]
    assert abs(y) > 1e-3 and np.sign(sum(rates)) == np.sign(y)


def test_the_torque_estimate_is_that_of_the_law(robot):
    asked = np.linspace(-8.0, 8.0, 12)
    np.testing.assert_allclose(robot.run(3, law(kp=0.0, kd=0.0, tau=asked)).tau, asked, atol=1 / 128)


def test_torque_ends_at_the_motors_limit(robot):
    limit = np.array(ROBOT.per_joint("torque_limit")) * np.tile([1.0, -1.0], 6)
    asked = np.sign(limit) * 100.0
    np.testing.assert_allclose(robot.run(3, law(kp=0.0, kd=0.0, tau=asked)).tau, limit, atol=1 / 128)


def test_a_law_holds_its_angles_and_without_one_the_legs_sink_damped(robot):
    held = robot.run(10, law())
    np.testing.assert_allclose(held.q, LEGS_UP, atol=0.05)
    sinking = robot.run(20)
    assert np.abs(sinking.dq).max() > 0.1
    np.testing.assert_allclose(sinking.tau, -DAMPING_KD * sinking.dq, atol=0.3)


def test_damping_acts_against_motion(robot):
    robot.run(8, law(kp=0.0, kd=0.0, tau=np.full(12, 5.0)))
    swinging = robot.run(1, damping_law(DAMPING_KD))
    assert (swinging.tau * swinging.dq <= 0.01).all() and np.abs(swinging.tau).max() > 1.0
    assert np.abs(robot.run(30, damping_law(DAMPING_KD)).dq).max() < np.abs(swinging.dq).max()


def test_close_leaves_it_damping_whatever_was_asked_last(robot):
    robot.run(5, law(q=LEGS_UP + 0.5))
    robot.close()
    for _ in range(20):
        robot.step_plant()
    truth = robot.plant.truth()
    assert np.abs(truth.tau).max() > 0.1
    np.testing.assert_allclose(truth.tau, -DAMPING_KD * truth.dq, rtol=0.15, atol=0.3)


def test_closing_twice_is_closing_once(robot):
    robot.close()
    robot.robot.close()


@pytest.mark.parametrize("kind", KINDS)
def test_a_robot_that_breaks_down_is_a_fault_with_its_limit_and_a_remedy(kind):
    with machine(kind, first_answer_s=3.0, stale_s=0.5) as robot:
        robot.run(3, law(kp=0.0))
        robot.break_down()
        with pytest.raises(
            HardwareFault,
            match=r"not finite: lower the gains|old by its tick, limit .*: is it on|not answered within 3 s",
        ):
            while True:
                robot.robot.read()
                robot.robot.advance()
