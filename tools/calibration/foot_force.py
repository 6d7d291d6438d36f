"""Zero and scale of the foot sensors, and who carries how much of a standing robot."""

from __future__ import annotations

import numpy as np

from surefoot.config.robot import LEGS
from surefoot.tools.calibration.refusal import CannotCalibrate


def foot_zero(raw: np.ndarray) -> np.ndarray:
    """z = mean(raw) of feet in the air.

    Args:
        raw: (n, 4).

    Returns:
        (4,).
    """
    return raw.mean(axis=0)


def shares_of_weight(force: np.ndarray, p_xy: np.ndarray, com_xy: np.ndarray, weight: float) -> np.ndarray:
    """f' = f + A^T (A A^T)^-1 (b - A f): the nearest forces that carry the weight and turn nothing.

    A has the rows (1, x, y) of the feet, b is the weight times (1, x, y) of the centre of mass. Three of the four
    forces are so the scales' and the model's; only what the diagonal pairs bear against each other is left to the
    torques.

    Args:
        force: (4,) vertical forces by eq. (7) [N].
        p_xy: (4, 2) feet in a level frame [m].
        com_xy: (2,) centre of mass in the same [m].
        weight: [N].

    Returns:
        (4,) [N].
    """
    A = np.vstack([np.ones(4), p_xy.T])
    b = weight * np.array([1.0, *com_xy])
    return force + A.T @ np.linalg.solve(A @ A.T, b - A @ force)


def foot_scale(raw: np.ndarray, zero: np.ndarray, force: np.ndarray) -> np.ndarray:
    """s = f / (mean(raw) - z).

    Args:
        raw: (n, 4) of feet that stand.
        zero: (4,) of feet in the air.
        force: (4,) that they bear [N].

    Returns:
        (4,) newtons to one raw unit.

    Raises:
        CannotCalibrate: a sensor tells less under load than in the air, or next to nothing more.
    """
    told = raw.mean(axis=0) - zero
    spread = raw.std(axis=0) / np.sqrt(len(raw))
    if (told <= 10.0 * spread).any() or (told <= 0.0).any():
        worst = int(np.argmin(told))
        raise CannotCalibrate(
            f"the sensor of {LEGS[worst]} tells {told[worst]:.1f} more under {force[worst]:.0f} N than in air, "
            "too little: it is broken, or foot_zero is of another robot"
        )
    return force / told
