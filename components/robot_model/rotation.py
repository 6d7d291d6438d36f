"""Rotations as matrices, unit quaternions (w, x, y, z), rotation vectors and ZYX Euler angles [rad]."""

from __future__ import annotations

from math import asin, atan2, copysign, cos, pi, sin, sqrt

import numpy as np

_YZX, _ZXY = np.array([1, 2, 0]), np.array([2, 0, 1])


def skew(a: np.ndarray, out: np.ndarray | None = None) -> np.ndarray:
    """(..., 3, 3) matrix with skew(a) b = a x b; in `out`, whose diagonal is zero, if that is given."""
    if out is None:
        out = np.zeros((*a.shape, 3))
    x, y, z = a[..., 0], a[..., 1], a[..., 2]
    out[..., 2, 1], out[..., 0, 2], out[..., 1, 0] = x, y, z
    np.negative(x, out=out[..., 1, 2])
    np.negative(y, out=out[..., 2, 0])
    np.negative(z, out=out[..., 0, 1])
    return out


def cross(a: np.ndarray, b: np.ndarray) -> np.ndarray:
    """a x b of vectors (..., 3): to the bit what `np.cross` gives, in a third of the time."""
    return a[..., _YZX] * b[..., _ZXY] - a[..., _ZXY] * b[..., _YZX]


def exp_rotation(phi: np.ndarray) -> np.ndarray:
    """(3, 3) rotation about `phi` (3,) by its length."""
    x, y, z = phi.tolist()
    angle2 = x * x + y * y + z * z
    if angle2 < 1e-12:
        a, b = 1.0 - angle2 / 6.0, 0.5 - angle2 / 24.0
    else:
        angle = sqrt(angle2)
        a, b = sin(angle) / angle, (1.0 - cos(angle)) / angle2
    return np.array(
        [
            [1.0 - b * (y * y + z * z), b * x * y - a * z, b * x * z + a * y],
            [b * x * y + a * z, 1.0 - b * (x * x + z * z), b * y * z - a * x],
            [b * x * z - a * y, b * y * z + a * x, 1.0 - b * (x * x + y * y)],
        ]
    )


def log_rotation(R: np.ndarray) -> np.ndarray:
    """Rotation vector (3,) of a rotation matrix."""
    w, x, y, z = quaternion_of(R).tolist()
    length = sqrt(x * x + y * y + z * z)
    scale = 2.0 if length < 1e-9 else 2.0 * atan2(length, w) / length
    return np.array([scale * x, scale * y, scale * z])


def matrix_of(quat: np.ndarray) -> np.ndarray:
    """Rotation matrix (3, 3) of a unit quaternion (w, x, y, z)."""
    w, x, y, z = np.asarray(quat).tolist()
    return np.array(
        [
            [1 - 2 * (y * y + z * z), 2 * (x * y - w * z), 2 * (x * z + w * y)],
            [2 * (x * y + w * z), 1 - 2 * (x * x + z * z), 2 * (y * z - w * x)],
            [2 * (x * z - w * y), 2 * (y * z + w * x), 1 - 2 * (x * x + y * y)],
        ]
    )


def quaternion_of(R: np.ndarray) -> np.ndarray:
    """Unit quaternion (w, x, y, z) with w >= 0 of a rotation matrix."""
    (a, b, c), (d, e, f), (g, h, i) = R.tolist()
    w = 0.5 * sqrt(max(1.0 + a + e + i, 0.0))
    x = copysign(0.5 * sqrt(max(1.0 + a - e - i, 0.0)), h - f)
    y = copysign(0.5 * sqrt(max(1.0 - a + e - i, 0.0)), c - g)
    z = copysign(0.5 * sqrt(max(1.0 - a - e + i, 0.0)), d - b)
    quat = np.array([w, x, y, z])
    return quat / sqrt(w * w + x * x + y * y + z * z)


def matrix_of_rpy(rpy: np.ndarray) -> np.ndarray:
    """R = Rz(yaw) Ry(pitch) Rx(roll), (3, 3)."""
    roll, pitch, yaw = np.asarray(rpy).tolist()
    return np.array(rows_of_rpy(cos(roll), cos(pitch), cos(yaw), sin(roll), sin(pitch), sin(yaw)))


def nearer_way(change: np.ndarray) -> np.ndarray:
    """A change of angles [rad] by the nearer way round; one within half a turn stays the same to the bit."""
    return change - 2.0 * pi * np.round(change / (2.0 * pi))


def pose_change(start: np.ndarray, end: np.ndarray) -> np.ndarray:
    """(6,) from one pose x, y, z [m], roll, pitch, yaw [rad] to another, turning the nearer way."""
    change = end - start
    change[3:] = nearer_way(change[3:])
    return change


def rows_of_rpy(cr, cp, cy, sr, sp, sy) -> tuple:
    """The rows of Rz(yaw) Ry(pitch) Rx(roll) from cosines and sines of roll, pitch, yaw: of one or of many."""
    return (
        (cy * cp, cy * sp * sr - sy * cr, cy * sp * cr + sy * sr),
        (sy * cp, sy * sp * sr + cy * cr, sy * sp * cr - cy * sr),
        (-sp, cp * sr, cp * cr),
    )


def rpy_of(R: np.ndarray) -> np.ndarray:
    """Roll, pitch, yaw (3,) of a rotation matrix."""
    return np.array([atan2(R[2, 1], R[2, 2]), asin(min(1.0, max(-1.0, -R[2, 0]))), atan2(R[1, 0], R[0, 0])])
