"""Batches of rotations: matrices (N, 3, 3), rotation vectors (N, 3) [rad], quaternions (N, 4) as (x, y, z, w)."""

from __future__ import annotations

import numpy as np

from surefoot.components.robot_model.rotation import rows_of_rpy, skew

_EYE3 = np.eye(3)


def exp_rotations(phi: np.ndarray) -> np.ndarray:
    """(N, 3, 3) rotations of (N, 3) rotation vectors."""
    K = skew(phi)
    return _rodrigues(K, K @ K, _squared_length(phi))


def exp_rotations_and_jacobians(phi: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """(N, 3, 3) rotations and right Jacobians J_r: exp(phi + d) = exp(phi) exp(J_r d) to first order.

    The Jacobian is its series in the angle: good to 1e-6 at 0.3 rad.
    """
    K = skew(phi)
    K2 = K @ K
    angle2 = _squared_length(phi)
    jacobian = (angle2 * (1.0 / 24.0) - 0.5)[:, None, None] * K
    jacobian += (1.0 / 6.0 - angle2 * (1.0 / 120.0))[:, None, None] * K2
    jacobian += _EYE3
    return _rodrigues(K, K2, angle2), jacobian


def log_rotations(R: np.ndarray) -> np.ndarray:
    """(N, 3) rotation vectors of (N, 3, 3) rotations of less than pi."""
    quat = quaternions_of(R)
    vector, w = quat[:, :3], quat[:, 3]
    # Below the floor both the sine and the angle are the half angle itself, and w is one.
    sine = np.sqrt(np.maximum(_squared_length(vector), 1e-24))
    return (2.0 * np.arctan2(sine, w) / sine)[:, None] * vector


def quaternions_of(R: np.ndarray) -> np.ndarray:
    """(N, 4) quaternions (x, y, z, w), w > 0, of rotations of less than pi."""
    quat = np.empty((len(R), 4))
    w = 0.5 * np.sqrt(np.maximum(1.0 + R[:, 0, 0] + R[:, 1, 1] + R[:, 2, 2], 1e-12))
    quat[:, 3] = w
    np.subtract(R[:, 2, 1], R[:, 1, 2], out=quat[:, 0])
    np.subtract(R[:, 0, 2], R[:, 2, 0], out=quat[:, 1])
    np.subtract(R[:, 1, 0], R[:, 0, 1], out=quat[:, 2])
    quat[:, :3] *= (0.25 / w)[:, None]
    return quat


def matrices_of_rpy(rpy: np.ndarray) -> np.ndarray:
    """(N, 3, 3) R = Rz(yaw) Ry(pitch) Rx(roll) of (N, 3) angles."""
    R = np.empty((len(rpy), 3, 3))
    for i, row in enumerate(rows_of_rpy(*np.cos(rpy).T, *np.sin(rpy).T)):
        R[:, i, 0], R[:, i, 1], R[:, i, 2] = row
    return R


def _squared_length(vectors: np.ndarray) -> np.ndarray:
    x, y, z = vectors.T
    return x * x + y * y + z * z


def _rodrigues(K: np.ndarray, K2: np.ndarray, angle2: np.ndarray) -> np.ndarray:
    """I + sin(a)/a K + (1 - cos a)/a^2 K^2."""
    # Below the floor both quotients are at their limits.
    half = 0.5 * np.sqrt(np.maximum(angle2, 1e-24))
    sinc_half = np.sin(half) / half
    R = (sinc_half * np.cos(half))[:, None, None] * K
    R += (0.5 * sinc_half * sinc_half)[:, None, None] * K2
    R += _EYE3
    return R
