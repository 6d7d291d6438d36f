"""The gate's own attitude: independent of the estimator, so that a fault of that one cannot hide a fall."""

from __future__ import annotations

from math import acos, nan, sqrt

import numpy as np

from surefoot.config.robot import GRAVITY
from surefoot.hw.gate.check import Check, Violation

_GAP_S = 0.1  # after a longer one the gyroscope cannot tell what has become of the attitude
_DOUBT = 0.2  # an accelerometer that is off gravity by this share is moved by something else, and not believed


class TiltWatch:
    """Complementary filter of the upward direction in the trunk.

    The gyroscope turns it, the accelerometer draws it with the filter's time constant, the less the more its
    magnitude differs from gravity's.

    Attributes:
        tilt: from upright [rad]; NaN before there is one.
    """

    def __init__(self, limit: float, filter_s: float):
        """`limit`: of the tilt [rad]; `filter_s`: the filter's time constant [s]."""
        self._limit, self._filter_s = limit, filter_s
        self._up = (0.0, 0.0, 0.0)
        self._t = nan
        self.tilt = nan

    def violation(self, omega_WB_B: np.ndarray, acc_B: np.ndarray, t: float) -> Violation | None:
        """Follow gyroscope (3,) [rad/s] and accelerometer (3,) [m/s^2] to time `t` [s]."""
        wx, wy, wz = omega_WB_B.tolist()
        ax, ay, az = acc_B.tolist()
        x, y, z = self._up
        force, dt = sqrt(ax * ax + ay * ay + az * az), t - self._t
        if 0.0 <= dt <= _GAP_S:
            trust = max(0.0, 1.0 - abs(force / GRAVITY - 1.0) / _DOUBT)
            stay = 1.0 - min(dt / self._filter_s, 1.0) * trust
            draw = (1.0 - stay) / (force or 1.0)
            turned = x + dt * (y * wz - z * wy), y + dt * (z * wx - x * wz), z + dt * (x * wy - y * wx)
            x, y, z = stay * turned[0] + draw * ax, stay * turned[1] + draw * ay, stay * turned[2] + draw * az
        else:
            x, y, z = ax, ay, az
        length = sqrt(x * x + y * y + z * z)
        if length == 0.0:  # weightless from the start: which way is up?
            return None
        self._up, self._t = (x / length, y / length, z / length), t
        self.tilt = acos(max(-1.0, min(1.0, self._up[2])))
        if self.tilt <= self._limit:
            return None
        return Violation(Check.TILT, f"trunk tilts by {self.tilt:.2f} rad, limit {self._limit:.2f} rad")
