"""Biases of gyroscope and accelerometer from a trunk at rest."""

from __future__ import annotations

import numpy as np

from surefoot.tools.calibration.refusal import CannotCalibrate, refuse_below

_ROUNDS = 20  # of Gauss-Newton: it has converged long before


def gyroscope_bias(omega_B: np.ndarray) -> np.ndarray:
    """b = mean(omega): a trunk at rest turns with the earth alone, 7e-5 rad/s.

    Args:
        omega_B: (n, 3) [rad/s].

    Returns:
        (3,) [rad/s].
    """
    return omega_B.mean(axis=0)


def bias_along_gravity(acc_B: np.ndarray, gravity: float) -> np.ndarray:
    """b = (1 - g / |a|) a: all that one attitude tells that nobody knows.

    Across gravity a bias looks like a tilt, b / g, and stays unknown; along it a tilt of delta between measured
    and true gravity is an error of g delta^2 / 2 only.

    Args:
        acc_B: (3,) mean specific force [m/s^2].
        gravity: [m/s^2].

    Returns:
        (3,) [m/s^2].
    """
    return (1.0 - gravity / np.linalg.norm(acc_B)) * acc_B


def bias_on_level_floor(acc_B: np.ndarray, up_B: np.ndarray, gravity: float) -> np.ndarray:
    """b = a - g n: the direction of gravity is the floor's normal, which the standing legs tell.

    A floor that is off by delta, or feet by as much over the stance, is an error of g delta across gravity.

    Args:
        acc_B: (3,) mean specific force [m/s^2].
        up_B: (3,) the floor's unit normal n in the trunk.
        gravity: [m/s^2].

    Returns:
        (3,) [m/s^2].
    """
    return acc_B - gravity * up_B


def bias_of_attitudes(acc_B: np.ndarray, gravity: float, spread_min: float) -> tuple[np.ndarray, np.ndarray]:
    """min over b of sum_k (|a_k - b| - g)^2: the means of all attitudes lie on a sphere of radius g about b.

    Args:
        acc_B: (k, 3) mean specific force in each attitude [m/s^2].
        gravity: [m/s^2].
        spread_min: least root mean square of gravity's direction along any axis; 0.577 when it is even.

    Returns:
        (3,) bias, (3,) its standard deviation by what is left over [m/s^2]; the latter is 0 with three attitudes.

    Raises:
        CannotCalibrate: fewer than three attitudes, or they are too much alike.
    """
    count = len(acc_B)
    if count < 3:
        raise CannotCalibrate(f"{count} attitudes, at least 3: three figures of the bias need as many")
    bias = np.zeros(3)
    for _ in range(_ROUNDS):
        off = acc_B - bias
        length = np.linalg.norm(off, axis=1)
        direction = off / length[:, None]
        bias = bias + np.linalg.lstsq(direction, length - gravity, rcond=None)[0]
    spread = np.linalg.svd(direction, compute_uv=False)[-1] / np.sqrt(count)
    refuse_below("spread of the attitudes", spread, spread_min, "", "tilt the trunk further, about both axes")
    left = np.linalg.norm(acc_B - bias, axis=1) - gravity
    variance = (left @ left) / max(count - 3, 1)
    return bias, np.sqrt(variance * np.diag(np.linalg.inv(direction.T @ direction)))


def floor_normal(p_BF: np.ndarray) -> np.ndarray:
    """n = argmin over |n| = 1 of sum_i (n . (p_i - mean p))^2, upwards in the trunk.

    Args:
        p_BF: (4, 3) foot centres in the trunk [m].

    Returns:
        (3,) unit normal of the plane through the feet.
    """
    normal = np.linalg.svd(p_BF - p_BF.mean(axis=0))[2][-1]
    return normal * np.sign(normal[2])
