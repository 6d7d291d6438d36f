"""Each estimate is what its equation says: it finds what was put in, and refuses what cannot tell."""

import numpy as np
import pytest

from surefoot.components.estimator.contact_force import ContactForce
from surefoot.config.deployment import Deployment
from surefoot.config.robot import GRAVITY, load_robot
from surefoot.tools.calibration.body_model import BodyModel
from surefoot.tools.calibration.foot_force import foot_scale, shares_of_weight
from surefoot.tools.calibration.inertial_sensors import bias_along_gravity, bias_of_attitudes, floor_normal
from surefoot.tools.calibration.joint_friction import fit_friction, swing
from surefoot.tools.calibration.joint_torque import noise_at_rest, noise_under_control, offset_at_rest
from surefoot.tools.calibration.refusal import CannotCalibrate
from surefoot.tools.calibration.thresholds import force_noise, friction_force, low_pass_share, propose

ROBOT = load_robot("aliengo")
MODEL = BodyModel(ROBOT)
STAND_Q = np.tile(ROBOT.nominal.stand_q, 4)
UP = np.array([0.0, 0.0, 1.0])
BIAS = np.array([0.05, -0.08, 0.12])


def tilted(roll, pitch):
    """Gravity's opposite in a trunk that is rolled and pitched."""
    return np.array([-np.sin(pitch), np.sin(roll) * np.cos(pitch), np.cos(roll) * np.cos(pitch)])


def test_one_attitude_tells_the_bias_along_gravity_and_takes_the_rest_for_a_tilt():
    found = bias_along_gravity(GRAVITY * UP + BIAS, GRAVITY)
    assert found[2] == pytest.approx(BIAS[2], abs=2e-3)
    assert np.abs(found[:2]).max() < 2e-3
    # A trunk that is tilted by a degree instead of a sensor that is off by 0.17 m/s^2: nobody can tell.
    assert np.abs(bias_along_gravity(GRAVITY * tilted(0.0, 0.0175), GRAVITY)).max() < 1e-9


@pytest.mark.parametrize("noise", [0.0, 0.002])
def test_attitudes_tell_all_of_it(noise):
    rng = np.random.default_rng(1)
    attitudes = [(0.0, 0.0), (0.6, 0.0), (-0.6, 0.0), (0.0, 0.6), (0.0, -0.6)]
    acc = np.array([GRAVITY * tilted(*each) + BIAS for each in attitudes]) + noise * rng.normal(size=(5, 3))
    bias, std = bias_of_attitudes(acc, GRAVITY, 0.2)
    np.testing.assert_allclose(bias, BIAS, atol=max(5.0 * noise, 1e-9))
    assert (np.abs(bias - BIAS) <= 4.0 * std + 1e-9).all()


def test_attitudes_that_are_alike_or_too_few_tell_nothing():
    alike = np.array([GRAVITY * tilted(roll, 0.0) for roll in (0.0, 0.05, 0.1)])
    with pytest.raises(
        CannotCalibrate, match=r"spread of the attitudes = .*, at least 0\.2: tilt the trunk further"
    ):
        bias_of_attitudes(alike, GRAVITY, 0.2)
    with pytest.raises(CannotCalibrate, match="2 attitudes, at least 3"):
        bias_of_attitudes(alike[:2], GRAVITY, 0.2)


def test_the_floors_normal_is_that_of_the_feet():
    R = np.array([[0.995, 0.0, 0.0998], [0.0, 1.0, 0.0], [-0.0998, 0.0, 0.995]])
    np.testing.assert_allclose(floor_normal(MODEL.feet(STAND_Q)[0] @ R.T), R @ UP, atol=1e-3)


def test_a_creeping_joints_damping_is_no_offset():
    rng = np.random.default_rng(2)
    rate, offset = np.linspace(-0.02, 0.02, 12), np.linspace(-1.0, 1.0, 12)
    tau = offset - 3.0 * rate + 0.5 * rng.normal(size=(5000, 12))
    np.testing.assert_allclose(offset_at_rest(tau, rate, 3.0), offset, atol=4.0 * 0.5 / np.sqrt(5000))
    np.testing.assert_allclose(noise_at_rest(tau), 0.5, rtol=0.05)
    slow = 5.0 * np.sin(np.arange(5000) / 500.0)[:, None]
    np.testing.assert_allclose(noise_under_control(tau + slow), 0.5, rtol=0.05)


def test_friction_is_told_from_offset_and_model():
    rng = np.random.default_rng(3)
    motion = np.array([swing(t, 12.0, 0.25, 0.5) for t in np.arange(0.0, 12.0, 0.002)])
    x, v = motion.T
    np.testing.assert_allclose(np.gradient(x, 0.002)[1:-1], v[1:-1], atol=1e-4)
    assert abs(v[0]) < 1e-9 and np.abs(v).max() == pytest.approx(2.0 * np.pi * 0.5 * 0.25, rel=0.05)
    tau = 0.4 * np.sign(v) + 0.2 * v + 0.7 + 3.0 * np.sin(x)
    fit = fit_friction(tau + 0.5 * rng.normal(size=len(v)), v, 3.0 * np.sin(x), 0.1)
    assert abs(fit.coulomb - 0.4) < 4.0 * fit.coulomb_std < 0.1
    assert abs(fit.viscous - 0.2) < 4.0 * fit.viscous_std < 0.2
    assert fit.centre == pytest.approx(0.7, abs=0.03)
    with pytest.raises(CannotCalibrate, match="it hardly moved; is its motor alive"):
        fit_friction(tau, 0.01 * v, x, 0.1)


def test_four_feet_carry_the_weight_and_turn_nothing():
    p_xy, com = MODEL.level(UP, STAND_Q)
    force = shares_of_weight(np.array([70.0, 40.0, 50.0, 60.0]), p_xy, com, MODEL.weight)
    assert force.sum() == pytest.approx(MODEL.weight)
    np.testing.assert_allclose(force @ p_xy, MODEL.weight * com)
    np.testing.assert_allclose(shares_of_weight(force, p_xy, com, MODEL.weight), force)
    raw = force / [0.5, 1.0, 2.0, 4.0] + [10.0, -20.0, 30.0, 0.0]
    scale = foot_scale(np.tile(raw, (5, 1)), np.array([10.0, -20.0, 30.0, 0.0]), force)
    np.testing.assert_allclose(scale, [0.5, 1.0, 2.0, 4.0])
    with pytest.raises(CannotCalibrate, match=r"the sensor of FR tells -5\.0 more"):
        foot_scale(np.tile([80.0, -25.0, 90.0, 9.0], (5, 1)), np.array([10.0, -20.0, 30.0, 0.0]), force)


def test_what_a_foot_bears_is_eq_7s():
    force_B = np.array([[5.0, -3.0, 60.0], [0.0, 0.0, 50.0], [-4.0, 2.0, 70.0], [1.0, 1.0, 55.0]])
    _, J_B = MODEL.feet(STAND_Q)
    gravity = MODEL.torques(UP, STAND_Q, np.zeros(12), np.zeros(12))
    tau = gravity - (force_B[:, None] @ J_B).reshape(12)
    np.testing.assert_allclose(MODEL.vertical_forces(UP, STAND_Q, tau), force_B[:, 2], atol=1e-9)
    bias = ContactForce(ROBOT, 0.1).bias(np.eye(3), np.array([1.0, 0, 0, 0]), np.zeros(3), STAND_Q, np.zeros(12))
    np.testing.assert_allclose(gravity, bias, atol=1e-12)


def test_noise_and_friction_of_a_force_are_those_of_eq_7():
    rng = np.random.default_rng(4)
    _, J_B = MODEL.feet(STAND_Q)
    tau_std = np.linspace(0.1, 1.0, 12)
    tau = tau_std * rng.normal(size=(20000, 12))
    force = np.array([ContactForce.force(J_B, each, np.zeros(12))[:, 2] for each in tau[:4000]])
    np.testing.assert_allclose(force.std(axis=0), force_noise(J_B, UP, tau_std), rtol=0.05)
    worst = friction_force(J_B, UP, MODEL.friction)
    held = MODEL.friction * rng.choice([-1.0, 1.0], size=(200, 12))
    sampled = np.array([ContactForce.force(J_B, each, np.zeros(12))[:, 2] for each in held])
    np.testing.assert_allclose(np.abs(sampled).max(axis=0), worst, rtol=1e-3)
    gain, state, out = 1.0 - np.exp(-2.0 * np.pi * 30.0 / 500.0), 0.0, []
    for each in rng.normal(size=50000):
        state += gain * (each - state)
        out.append(state)
    assert np.std(out) == pytest.approx(low_pass_share(30.0, 500.0), rel=0.03)


def test_quieter_torques_allow_lower_thresholds():
    _, J_B = MODEL.feet(STAND_Q)
    loud, quiet = (propose(Deployment(), J_B, UP, np.full(12, std), MODEL.friction) for std in (0.5, 0.1))
    assert [each.key for each in loud] == [each.key for each in quiet]
    assert all(a.proposed > b.proposed for a, b in zip(loud, quiet, strict=True))
    off, on, least = loud
    assert off.proposed < on.proposed < least.proposed
    assert (off.present, on.present) == (6.0, 10.0)
