"""The linearisation is the derivative of the step, and the step is Pinocchio's dynamics."""

import numpy as np
import pinocchio as pin
import pytest

from surefoot.components.ocp.centroidal_dynamics import CentroidalDynamics, Trajectory
from surefoot.components.robot_model import build_model, foot_frame_ids
from surefoot.config.robot import GRAVITY, load_robot

ROBOT = load_robot("aliengo")
DYNAMICS = CentroidalDynamics(ROBOT, 1)
MODEL = build_model(ROBOT)
DT = 0.015
NORMAL = np.array([0.1, -0.05, 1.0]) / np.sqrt(1.0125)
GAIN = 20.0


def exact_velocity(state, w):
    """v of S v = (m h; w), by Pinocchio alone."""
    h, p, R, q = state
    data = MODEL.createData()
    configuration = np.concatenate([p, pin.Quaternion(R).coeffs(), q])
    A_g = pin.computeCentroidalMap(MODEL, data, configuration)
    pin.computeJointJacobians(MODEL, data, configuration)
    pin.updateFramePlacements(MODEL, data)
    J = [pin.getFrameJacobian(MODEL, data, f, pin.LOCAL_WORLD_ALIGNED)[:3] for f in foot_frame_ids(MODEL)]
    feet = np.array([data.oMf[f].translation for f in foot_frame_ids(MODEL)])
    v = np.linalg.solve(np.vstack([A_g, *J]), np.concatenate([ROBOT.mass * h, w.ravel()]))
    return v, feet, pin.centerOfMass(MODEL, data, configuration).copy()


def exact_step(state, u, contact, rate, reference):
    """One Euler step from first principles; u (4, 3) is force or foot velocity."""
    h, p, R, q = state
    _, feet, _ = exact_velocity(state, np.zeros((4, 3)))
    w = np.zeros((4, 3))
    for leg in np.flatnonzero(~contact):
        along = rate[leg] - GAIN * (feet[leg] @ NORMAL - reference[leg])
        w[leg] = u[leg] - (u[leg] @ NORMAL) * NORMAL + along * NORMAL
    v, feet, com = exact_velocity(state, w)
    force = u * contact[:, None]
    linear = force.sum(axis=0) / ROBOT.mass - [0.0, 0.0, GRAVITY]
    angular = np.cross(feet - com, force).sum(axis=0) / ROBOT.mass
    after = (
        h + DT * np.concatenate([linear, angular]),
        p + DT * R @ v[:3],
        R @ pin.exp3(v[3:6] * DT),
        q + DT * v[6:],
    )
    return after, v


def moved(state, delta):
    h, p, R, q = state
    return h + delta[:6], p + delta[6:9], R @ pin.exp3(delta[9:12]), q + delta[12:]


def difference(a, b):
    return np.concatenate([a[0] - b[0], a[1] - b[1], pin.log3(b[2].T @ a[2]), a[3] - b[3]])


def random_case(seed):
    rng = np.random.default_rng(seed)
    q = np.tile(ROBOT.nominal.stand_q, 4) + 0.2 * rng.normal(size=12)
    # Up to a few rad/s: angular momentum per mass is about 0.04 m^2/s for one.
    h = np.array([0.3, 0.3, 0.3, 0.03, 0.06, 0.06]) * rng.normal(size=6)
    state = h, rng.normal(size=3), pin.exp3(0.4 * rng.normal(size=3)), q
    contact = np.array([True, seed % 2 == 0, True, True])
    u = np.where(contact[:, None], [0.0, 0.0, 60.0] + 10 * rng.normal(size=(4, 3)), rng.normal(size=(4, 3)))
    return state, u, contact, rng.normal(size=4), rng.normal(size=4)


def linearised(state, u, contact, rate, reference):
    after, v = exact_step(state, u, contact, rate, reference)
    iterate = Trajectory(
        h=np.array([state[0], after[0]]),
        p_WB=np.array([state[1], after[1]]),
        R_WB=np.array([state[2], after[2]]),
        q=np.array([state[3], after[3]]).reshape(2, 4, 3),
        force_W=(u * contact[:, None])[None],
        foot_velocity_W=(u * ~contact[:, None])[None],
        v=v[None],
    )
    linear = DYNAMICS.linearise(iterate, contact[None], DT, NORMAL, rate[None], GAIN, reference[None])
    return linear, after, v


@pytest.mark.parametrize("seed", range(4))
def test_the_defect_of_an_exact_step_is_zero(seed):
    linear, _, _ = linearised(*random_case(seed))
    np.testing.assert_allclose(linear.c[0], 0.0, atol=1e-9)
    np.testing.assert_allclose(linear.v_c[0], 0.0, atol=1e-9)


@pytest.mark.parametrize("seed", range(4))
def test_state_derivatives(seed):
    state, u, contact, rate, reference = random_case(seed)
    linear, _, _ = linearised(state, u, contact, rate, reference)
    step = 1e-6
    A, v_x = np.empty((24, 24)), np.empty((18, 24))
    for i in range(24):
        delta = step * np.eye(24)[i]
        up, v_up = exact_step(moved(state, delta), u, contact, rate, reference)
        down, v_down = exact_step(moved(state, -delta), u, contact, rate, reference)
        A[:, i], v_x[:, i] = difference(up, down) / (2 * step), (v_up - v_down) / (2 * step)
    np.testing.assert_allclose(linear.v_x[0], v_x, atol=2e-6)
    np.testing.assert_allclose(linear.A[0], A, atol=2e-5)


@pytest.mark.parametrize("seed", range(4))
def test_input_derivatives(seed):
    state, u, contact, rate, reference = random_case(seed)
    linear, _, _ = linearised(state, u, contact, rate, reference)
    step = 1e-5
    B = np.empty((24, 12))
    for i in range(12):
        delta = step * np.eye(12)[i].reshape(4, 3)
        up, _ = exact_step(state, u + delta, contact, rate, reference)
        down, _ = exact_step(state, u - delta, contact, rate, reference)
        B[:, i] = difference(up, down) / (2 * step)
    np.testing.assert_allclose(linear.B[0], B, atol=2e-5)


@pytest.mark.parametrize("seed", range(4))
def test_places_are_pinocchios_and_their_derivatives_those_of_the_places(seed):
    state, u, contact, rate, reference = random_case(seed)
    linear, _, _ = linearised(state, u, contact, rate, reference)

    def places(state):
        _, feet, com = exact_velocity(state, np.zeros((4, 3)))
        return np.vstack([feet, com])

    np.testing.assert_allclose(np.vstack([linear.p_WF[0], linear.com_W]), places(state), atol=1e-12)
    step = 1e-6
    for i in range(18):
        delta = np.r_[np.zeros(6), step * np.eye(18)[i]]
        slope = (places(moved(state, delta)) - places(moved(state, -delta))) / (2 * step)
        np.testing.assert_allclose(linear.place_x[0, ..., i], slope, atol=1e-8)


def test_a_linearisation_does_not_depend_on_those_before_it():
    robots = CentroidalDynamics(ROBOT, 1), CentroidalDynamics(ROBOT, 1)
    results = []
    for dynamics, seeds in zip(robots, ((0, 1, 2), (2,)), strict=True):
        for seed in seeds:
            state, u, contact, rate, reference = random_case(seed)
            after, v = exact_step(state, u, contact, rate, reference)
            iterate = Trajectory(
                *(np.array([a, b]) for a, b in zip(state[:3], after[:3], strict=True)),
                q=np.array([state[3], after[3]]).reshape(2, 4, 3),
                force_W=(u * contact[:, None])[None],
                foot_velocity_W=(u * ~contact[:, None])[None],
                v=v[None],
            )
            linear = dynamics.linearise(iterate, contact[None], DT, NORMAL, rate[None], GAIN, reference[None])
        results.append(linear)
    np.testing.assert_array_equal(results[0].F, results[1].F)
    np.testing.assert_array_equal(results[0].V, results[1].V)
