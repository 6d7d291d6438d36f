"""Offset and noise of the torque estimates."""

from __future__ import annotations

import numpy as np


def offset_at_rest(tau: np.ndarray, rate: np.ndarray, kd: float) -> np.ndarray:
    """o = mean(tau) + kd dq: a motor that damps a joint at rest makes -kd dq, next to nothing.

    What gravity asks of a hanging leg at rest is carried by friction and stops, not by the motor; to take the
    model's gravity torque off would mistake up to the whole Coulomb friction for an offset.

    Args:
        tau: (n, 12) estimates [N m].
        rate: (12,) mean velocity dq at which the joints still creep [rad/s].
        kd: of the damping [N m s/rad].

    Returns:
        (12,) [N m].
    """
    return tau.mean(axis=0) + kd * rate


def noise_at_rest(tau: np.ndarray) -> np.ndarray:
    """s = sqrt(sum (tau - mean(tau))^2 / (n - 1)).

    Args:
        tau: (n, 12) estimates of motors that do nothing [N m].

    Returns:
        (12,) standard deviation of one sample [N m].
    """
    return tau.std(axis=0, ddof=1)


def noise_under_control(tau: np.ndarray) -> np.ndarray:
    """s = sqrt(mean((tau_k+1 - tau_k)^2) / 2): what is not the controller's slow motion; an upper limit.

    Args:
        tau: (n, 12) estimates at 500 Hz [N m].

    Returns:
        (12,) standard deviation of one sample [N m].
    """
    return np.sqrt((np.diff(tau, axis=0) ** 2).mean(axis=0) / 2.0)
