"""What the noise and friction that were measured mean for the contact thresholds."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from surefoot.bus.topics import CYCLE_HZ
from surefoot.config.deployment import Deployment
from surefoot.tools.calibration.body_model import normal_gains

_OFF_STD, _ON_STD = 3.0, 5.0
"""Standard deviations beyond friction: an unloaded foot stays below the one in 99.9 % of looks, and three in a row
above the other are never seen."""


@dataclass(frozen=True)
class Proposal:
    """One setting: what it is, and what the figures ask for."""

    key: str
    present: float
    proposed: float
    why: str


def force_noise(J_B: np.ndarray, up_B: np.ndarray, tau_std: np.ndarray) -> np.ndarray:
    """s_f = sqrt(sum_j (n^T J^-T)_j^2 s_j^2): eq. (7) is linear in the torques.

    Args:
        J_B: (4, 3, 3) foot Jacobians [m/rad].
        up_B: (3,) normal n of the ground.
        tau_std: (12,) noise of a torque estimate [N m].

    Returns:
        (4,) standard deviation of the normal force [N].
    """
    return np.sqrt(((normal_gains(J_B, up_B) * tau_std.reshape(4, 3)) ** 2).sum(axis=1))


def friction_force(J_B: np.ndarray, up_B: np.ndarray, coulomb: np.ndarray) -> np.ndarray:
    """f_c = sum_j |n^T J^-T|_j c_j: what resting joints may hold back from the torques at the most.

    Args:
        J_B, up_B: as of `force_noise`.
        coulomb: (12,) [N m].

    Returns:
        (4,) [N].
    """
    return (np.abs(normal_gains(J_B, up_B)) * coulomb.reshape(4, 3)).sum(axis=1)


def low_pass_share(cutoff_hz: float, rate_hz: float) -> float:
    """sqrt(a / (2 - a)), a = 1 - exp(-2 pi f_c / f): what a first-order low-pass leaves of white noise."""
    a = 1.0 - np.exp(-2.0 * np.pi * cutoff_hz / rate_hz)
    return float(np.sqrt(a / (2.0 - a)))


def propose(
    deployment: Deployment, J_B: np.ndarray, up_B: np.ndarray, tau_std: np.ndarray, coulomb: np.ndarray
) -> tuple[Proposal, ...]:
    """Thresholds for the worst foot: off = f_c + 3 s, on = f_c + 5 s, and a stance foot twice f_c + 3 s.

    s is the noise that the estimator's low-pass leaves. A stance foot that bears less than twice what an unloaded
    one may seem to bear can be taken for one.

    Args:
        deployment: its present values.
        J_B, up_B, tau_std: as of `force_noise`.
        coulomb: (12,) friction of the joints [N m].
    """
    settings = deployment.estimator
    left = low_pass_share(settings.force_filter_hz, CYCLE_HZ)
    noise = float(left * force_noise(J_B, up_B, tau_std).max())
    friction = float(friction_force(J_B, up_B, coulomb).max())
    off, on = friction + _OFF_STD * noise, friction + _ON_STD * noise
    words = f"{friction:.1f} N of friction"
    return (
        Proposal(
            "estimator.contact_off_n", settings.contact_off_n, off, f"{words} + {_OFF_STD:g} x {noise:.2f} N"
        ),
        Proposal("estimator.contact_on_n", settings.contact_on_n, on, f"{words} + {_ON_STD:g} x {noise:.2f} N"),
        Proposal("wbc.force_min_n", deployment.wbc.force_min_n, 2.0 * off, "twice the first"),
    )
