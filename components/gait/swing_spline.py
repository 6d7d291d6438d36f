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


def _with_derivatives(coefficients: np.ndarray) -> np.ndarray:
    """(..., 6, 3) coefficients of quintics (..., 6) and of their first and second derivatives."""
    ranks = np.arange(1.0, 6.0)
    first, second = np.zeros_like(coefficients), np.zeros_like(coefficients)
    first[..., :5] = ranks * coefficients[..., 1:]
    second[..., :5] = ranks * first[..., 1:]
    return np.stack([coefficients, first, second], axis=-1)


# Of the five given numbers, to coefficients by (half, power, derivative).
_HEIGHT = np.moveaxis(_with_derivatives(_height_map().reshape(2, 6, 5).swapaxes(1, 2)), 1, 0).reshape(5, 36)
# From 0 to 1, at rest at both ends; unit speed at the start, at rest at the end, back at 0.
_BLEND = _with_derivatives(np.array([0.0, 0.0, 0.0, 10.0, -15.0, 6.0]))
_RUN_OUT = _with_derivatives(np.array([0.0, 1.0, 0.0, -6.0, 8.0, -3.0]))


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
        self._height = (given @ _HEIGHT).reshape(2, 6, 3)
        along = self._to - self._from
        self._along = along - (along @ self._normal) * self._normal if self._lands else along

    def sample(self, t: np.ndarray) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
        """Position, velocity and acceleration, each (n, 3) [m, m/s, m/s^2], at times t (n,) [s]."""
        duration = self.t1 - self.t0
        s = np.minimum(np.maximum((t - self.t0) / duration, 0.0), 1.0)
        # One column for each derivative; outside the swing only the position remains.
        rate = np.empty((len(t), 3))
        rate[:, 0] = 1.0
        rate[:, 1] = ((t >= self.t0) & (t < self.t1)) / duration
        rate[:, 2] = rate[:, 1] / duration
        powers = _powers_of(s)
        path = (rate * (powers @ _BLEND)).T[..., None] * self._along
        path[0] += self._from
        if not self._lands:
            path += duration * (rate * (powers @ _RUN_OUT)).T[..., None] * self._v_from
            return path[0], path[1], path[2]
        second = s >= 0.5
        powers = _powers_of(2.0 * s - second)
        height = np.where(second[:, None], powers @ self._height[1], powers @ self._height[0])
        height *= rate * _PER_HALF
        late = t - self.t1
        height[:, 0] -= self._from @ self._normal + self._speed * np.maximum(late, 0.0)
        height[late >= 0.0, 1] = -self._speed
        path += height.T[..., None] * self._normal
        return path[0], path[1], path[2]


_PER_HALF = np.array([1.0, 2.0, 4.0])  # a half has its own s, twice as fast: chain rule


def _powers_of(s: np.ndarray) -> np.ndarray:
    """(n, 6) powers 1, s, ..., s^5 of s (n,)."""
    powers = np.empty((len(s), 6))
    powers[:, 0], powers[:, 1:] = 1.0, s[:, None]
    return np.multiply.accumulate(powers, axis=1, out=powers)
