"""The closed-form leg is Pinocchio's leg."""

import numpy as np
import pinocchio as pin
import pytest

from surefoot.components.robot_model import LegKinematics, build_model, foot_frame_ids
from surefoot.config.robot import LEGS, load_robot


@pytest.fixture(scope="module")
def legs():
    robot = load_robot("aliengo")
    return LegKinematics(robot), build_model(robot)


def postures(kinematics, count):
    rng = np.random.default_rng(0)
    q = rng.uniform(kinematics.lower, kinematics.upper, (count, 4, 3))
    q[..., 0] *= 0.5
    q[..., 1] = rng.uniform(0.0, 1.5, (count, 4))
    return q


def test_position_and_jacobian_are_pinocchios(legs):
    kinematics, model = legs
    data = model.createData()
    for q in postures(kinematics, 20):
        configuration = pin.neutral(model)
        configuration[7:] = q.ravel()
        pin.computeJointJacobians(model, data, configuration)
        pin.framesForwardKinematics(model, data, configuration)
        for leg, frame in enumerate(foot_frame_ids(model)):
            np.testing.assert_allclose(kinematics.position(q)[leg], data.oMf[frame].translation, atol=1e-12)
            jacobian = pin.getFrameJacobian(model, data, frame, pin.LOCAL_WORLD_ALIGNED)
            np.testing.assert_allclose(
                kinematics.jacobian(q)[leg], jacobian[:3, 6 + 3 * leg : 9 + 3 * leg], atol=1e-12
            )


def test_thigh_axes_and_knees_are_pinocchios_and_the_length_lies_between(legs):
    kinematics, model = legs
    data = model.createData()
    for q in postures(kinematics, 20):
        configuration = pin.neutral(model)
        configuration[7:] = q.ravel()
        pin.forwardKinematics(model, data, configuration)
        thigh, knee = kinematics.joints(q)
        for leg, name in enumerate(LEGS):
            for point, joint in ((thigh, "thigh"), (knee, "calf")):
                placed = data.oMi[model.getJointId(f"{name}_{joint}")].translation
                np.testing.assert_allclose(point[leg], placed, atol=1e-12)
        feet = kinematics.position(q)
        np.testing.assert_allclose(kinematics.length(feet), np.linalg.norm(feet - thigh, axis=1), atol=1e-12)


def test_motion_is_position_and_jacobian_and_their_derivatives(legs):
    kinematics, _ = legs
    q = postures(kinematics, 20)
    dq = np.random.default_rng(1).normal(size=q.shape)
    motion = kinematics.motion(q, dq)
    np.testing.assert_allclose(motion.position, kinematics.position(q), atol=1e-14)
    np.testing.assert_allclose(motion.jacobian, kinematics.jacobian(q), atol=1e-14)
    np.testing.assert_allclose(
        motion.inverse @ motion.jacobian, np.broadcast_to(np.eye(3), (20, 4, 3, 3)), atol=1e-10
    )
    step = 1e-6
    for i in range(3):
        delta = step * np.eye(3)[i]
        up, down = kinematics.jacobian(q + delta) @ dq[..., None], kinematics.jacobian(q - delta) @ dq[..., None]
        np.testing.assert_allclose(motion.velocity_q[..., i], ((up - down) / (2 * step))[..., 0], atol=1e-8)


def test_inverse_returns_the_posture(legs):
    kinematics, _ = legs
    q = postures(kinematics, 50)
    solution, reachable = kinematics.inverse(kinematics.position(q))
    assert reachable.all()
    np.testing.assert_allclose(solution, q, atol=1e-9)


def test_a_point_out_of_reach_is_said_to_be_and_gives_the_longest_leg(legs):
    kinematics, _ = legs
    p_BF = kinematics.position(np.zeros((4, 3)) + [0.0, 0.7, -1.4])
    p_BF[2] += [0.0, 0.0, -1.0]
    q, reachable = kinematics.inverse(p_BF)
    np.testing.assert_array_equal(reachable, [True, True, False, True])
    assert q[2, 2] == pytest.approx(kinematics.upper[2, 2])
