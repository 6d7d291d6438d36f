"""The swing of a foot: two quintics along the surface normal, one along the surface (Sec. II-B.3)."""

from __future__ import annotations

import numpy as np

from surefoot.bus.messages import MotionReference


def _powers(s: float, order: int) -> np.ndarray:
    """Derivative of (1, s, ..., s^5) of an order, (6,)."""
    row = np.zeros(6)
    for power in range(order, 6):
        row[power] = np.prod(np.arange(power, power - order, -1.0)) * s ** (power - order)
    return row


def _height_map() -> np.ndarray:
    """(12, 5) coefficients of both quintics from (start, end, apex, lift-off speed, touch-down speed).

    Each quintic runs over its own s in [0, 1]; speeds are per half. Position and velocity are given at the
    ends and zero velocity at the apex, acceleration is zero at the ends, acceleration and jerk are
    continuous at the apex.
    """
    rows, right = [], []

    def condition(first: np.ndarray, second: np.ndarray, value: tuple[int, ...]) -> None:
        rows.append(np.concatenate([first, second]))
        right.append(np.bincount(value, minlength=5)[:5] if value else np.zeros(5))

    none = np.zeros(6)
    condition(_powers(0, 0), none, (0,))
    condition(_powers(0, 1), none, (3,))
    condition(_powers(0, 2), none, ())
    condition(_powers(1, 0), none, (2,))
    condition(_powers(1, 1), none, ())
    condition(none, _powers(0, 0), (2,))
    condition(none, _powers(0, 1), ())
    condition(_powers(1, 2), -_powers(0, 2), ())
    condition(_powers(1, 3), -_powers(0, 3), ())
    condition(none, _powers(1, 0), (1,))
    condition(none, _powers(1, 1), (4,))
    condition(none, _powers(1, 2), ())
    return np.linalg.solve(np.array(rows), np.array(right, float))


_HEIGHT = _height_map()
_RUN_OUT = np.array([0.0, 1.0, 0.0, -6.0, 8.0, -3.0])  # unit speed at the start, at rest at the end, back at 0
_BLEND = np.array([0.0, 0.0, 0.0, 10.0, -15.0, 6.0])  # from 0 to 1, at rest at both ends


class SwingSpline:
    """One swing from lift-off to touch-down.

    A foot that lands goes over an apex and, past the touch-down time, on against the normal at touch-down
    speed until contact is found. One that does not land (LEG_UP) moves to its end and stays.
    """

    def __init__(self, reference: MotionReference):
        self.t0, self.t1 = reference.swing_t0, max(reference.swing_t1, reference.swing_t0 + 1e-3)
        self._normal = reference.normal_W
        self._from, self._to = reference.swing_from, reference.swing_to
        self._lands = reference.swing_lands
        self._v_from = reference.swing_v_from
        self._speed = reference.swing_v_touch if reference.swing_lands else 0.0
        start, end = self._from @ self._normal, self._to @ self._normal
        half = 0.5 * (self.t1 - self.t0)
        apex = max(start, end) + reference.swing_height
        given = np.array([start, end, apex, half * reference.swing_v_lift, -half * self._speed])
        self._height = (_HEIGHT @ given).reshape(2, 6)
        self._half = half
        along = self._to - self._from
        self._along = along - (along @ self._normal) * self._normal if self._lands else along

    def sample(self, t: np.ndarray) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
        """Position, velocity and acceleration, each (n, 3) [m, m/s, m/s^2], at times t (n,) [s]."""
        duration = self.t1 - self.t0
        s = np.clip((t - self.t0) / duration, 0.0, 1.0)
        inside = ((t >= self.t0) & (t < self.t1)).astype(float)
        p = self._from + _polynomial(_BLEND, s, 0)[:, None] * self._along
        v = (inside * _polynomial(_BLEND, s, 1) / duration)[:, None] * self._along
        a = (inside * _polynomial(_BLEND, s, 2) / duration**2)[:, None] * self._along
        if not self._lands:
            p = p + duration * _polynomial(_RUN_OUT, s, 0)[:, None] * self._v_from
            v = v + (inside * _polynomial(_RUN_OUT, s, 1))[:, None] * self._v_from
            a = a + (inside * _polynomial(_RUN_OUT, s, 2) / duration)[:, None] * self._v_from
            return p, v, a
        second = (s >= 0.5).astype(int)
        coefficients = self._height[second].T
        part = 2.0 * s - second
        height = _polynomial(coefficients, part, 0) - self._from @ self._normal
        speed = inside * _polynomial(coefficients, part, 1) / self._half
        acceleration = inside * _polynomial(coefficients, part, 2) / self._half**2
        late = np.maximum(t - self.t1, 0.0)
        height = height - self._speed * late
        speed = np.where(t >= self.t1, -self._speed, speed)
        normal = self._normal
        return p + height[:, None] * normal, v + speed[:, None] * normal, a + acceleration[:, None] * normal


def _polynomial(coefficients: np.ndarray, s: np.ndarray, order: int) -> np.ndarray:
    """Derivative of an order of a quintic with coefficients (6,) or (6, n) at s (n,)."""
    result = np.zeros(len(s))
    for power in range(5, order - 1, -1):
        factor = 1.0
        for n in range(power, power - order, -1):
            factor *= n
        result = result * s + factor * coefficients[power]
    return result
