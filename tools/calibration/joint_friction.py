"""Friction of a joint that is swung to and fro."""

from __future__ import annotations

from dataclasses import dataclass
from math import cos, pi, sin

import numpy as np

from surefoot.tools.calibration.refusal import CannotCalibrate


@dataclass(frozen=True)
class FrictionFit:
    """Of one joint, with the standard deviations of the fit."""

    coulomb: float  # [N m]
    viscous: float  # [N m s/rad]
    centre: float  # what the torques are off in both directions alike: offset, and error of the model [N m]
    coulomb_std: float
    viscous_std: float


def fit_friction(tau: np.ndarray, dq: np.ndarray, model_tau: np.ndarray, slow_speed: float) -> FrictionFit:
    """Least squares of tau - tau_model = c sign(dq) + d dq + o over samples with |dq| > slow_speed.

    Args:
        tau: (n,) torque estimates of the joint [N m].
        dq: (n,) its velocity [rad/s].
        model_tau: (n,) what gravity and inertia ask of it, friction left out [N m].
        slow_speed: below it the sign of friction is not certain [rad/s].

    Raises:
        CannotCalibrate: it has hardly moved.
    """
    moves = np.abs(dq) > slow_speed
    v, left = dq[moves], (tau - model_tau)[moves]
    if min((v > 0.0).sum(), (v < 0.0).sum()) < 50:
        raise CannotCalibrate(
            f"{moves.sum()} samples faster than {slow_speed:g} rad/s, at least 50 each way: it hardly moved; is "
            "its motor alive and the leg free?"
        )
    columns = np.stack([np.sign(v), v, np.ones(len(v))], axis=1)
    fit = np.linalg.lstsq(columns, left, rcond=None)[0]
    variance = ((left - columns @ fit) ** 2).sum() / (len(v) - 3)
    std = np.sqrt(variance * np.diag(np.linalg.inv(columns.T @ columns)))
    # Friction takes, it never gives: a little below zero is noise.
    coulomb, viscous = max(float(fit[0]), 0.0), max(float(fit[1]), 0.0)
    return FrictionFit(coulomb, viscous, float(fit[2]), float(std[0]), float(std[1]))


def swing(t: float, seconds: float, amplitude: float, hz: float) -> tuple[float, float]:
    """x = A sin^2(pi t / T) sin(2 pi f t): begins and ends at rest, and meets every speed up to 2 pi f A.

    Args:
        t: since the begin, 0 to `seconds` [s].
        seconds: T.
        amplitude: A [rad].
        hz: f [1/s].

    Returns:
        Displacement and velocity [rad, rad/s].
    """
    a, w = pi / seconds, 2.0 * pi * hz
    window, slope = sin(a * t) ** 2, a * sin(2.0 * a * t)
    wave, rate = sin(w * t), w * cos(w * t)
    return amplitude * window * wave, amplitude * (slope * wave + window * rate)
