"""The closed-form leg is Pinocchio's leg."""

import numpy as np
import pinocchio as pin
import pytest

from surefoot.components.robot_model import LegKinematics, build_model, foot_frame_ids
from surefoot.config.robot import load_robot


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
