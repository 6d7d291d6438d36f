"""Batched rotations are Pinocchio's, down to no rotation at all."""

import numpy as np
import pinocchio as pin
import pytest

from surefoot.components.robot_model.rotation import cross, matrix_of_rpy, nearer_way
from surefoot.components.robot_model.rotations import (
    exp_rotations,
    exp_rotations_and_jacobians,
    log_rotations,
    matrices_of_rpy,
    quaternions_of,
)


@pytest.mark.parametrize("scale", [1.0, 1e-3, 1e-9, 1e-13, 0.0])
def test_exponential_and_logarithm(scale):
    phi = scale * np.random.default_rng(0).normal(size=(30, 3))
    R = exp_rotations(phi)
    np.testing.assert_allclose(R, [pin.exp3(p) for p in phi], atol=1e-12)
    np.testing.assert_allclose(log_rotations(R), phi, atol=1e-9 * scale + 1e-16)
    quat = np.array([pin.Quaternion(r).coeffs() for r in R])
    np.testing.assert_allclose(quaternions_of(R), np.sign(quat[:, 3:]) * quat, atol=1e-12)


def test_right_jacobians_are_good_to_the_order_of_their_series():
    phi = 0.08 * np.random.default_rng(0).normal(size=(30, 3))
    R, jacobian = exp_rotations_and_jacobians(phi)
    np.testing.assert_array_equal(R, exp_rotations(phi))
    np.testing.assert_allclose(jacobian, [pin.Jexp3(p) for p in phi], atol=1e-6)


def test_roll_pitch_yaw_of_one_and_of_many():
    rpy = np.random.default_rng(0).uniform(-1.5, 1.5, (30, 3))
    R = matrices_of_rpy(rpy)
    np.testing.assert_allclose(R, [pin.rpy.rpyToMatrix(*angles) for angles in rpy], atol=1e-15)
    np.testing.assert_allclose(R, [matrix_of_rpy(angles) for angles in rpy], atol=1e-15)


def test_a_change_of_angle_goes_the_nearer_way_and_a_small_one_stays_what_it_is_to_the_bit():
    assert nearer_way(np.array([0.3, -3.1, 0.1 + 0.2])).tolist() == [0.3, -3.1, 0.1 + 0.2]
    np.testing.assert_allclose(nearer_way(np.array([2.0 * np.pi - 0.02, 0.02 - 2.0 * np.pi])), [-0.02, 0.02])


def test_the_vector_product_is_that_of_numpy_to_the_bit():
    a, b = np.random.default_rng(0).normal(size=(2, 30, 3))
    np.testing.assert_array_equal(cross(a, b), np.cross(a, b))
    np.testing.assert_array_equal(cross(a[0], b), np.cross(a[0], b))
    np.testing.assert_array_equal(cross(a, b[0]), np.cross(a, b[0]))
