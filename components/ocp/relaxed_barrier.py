"""The relaxed logarithmic barrier that makes a cost of every inequality of eq. (1e); its figures are Table I."""

from __future__ import annotations

from dataclasses import dataclass
from math import log

import numpy as np


@dataclass(frozen=True)
class RelaxedBarrier:
    """-mu ln h for h > delta, continued below by the parabola with the same value, slope and curvature.

    Feller and Ebenbauer 2017 (reference [23] of the paper). Defined for every h: outside its domain the
    constraint is a quadratic penalty.

    Attributes:
        mu: weight.
        delta: relaxation, in the unit of h.
    """

    mu: float
    delta: float

    def value(self, h: np.ndarray) -> np.ndarray:
        """Penalty of each h."""
        inside = -np.log(np.maximum(h, self.delta))
        z = (h - 2.0 * self.delta) / self.delta
        relaxed = 0.5 * (z * z - 1.0) - log(self.delta)
        return self.mu * np.where(h > self.delta, inside, relaxed)

    def derivatives(self, h: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """First and second derivative with respect to h; the second is positive everywhere."""
        inverse = 1.0 / np.maximum(h, self.delta)
        outside = np.minimum(h - self.delta, 0.0)
        return (self.mu / self.delta**2) * outside - self.mu * inverse, self.mu * inverse * inverse

    def gradient(self, h: np.ndarray) -> np.ndarray:
        """First derivative with respect to h."""
        return self.derivatives(h)[0]

    def hessian(self, h: np.ndarray) -> np.ndarray:
        """Second derivative with respect to h."""
        return self.derivatives(h)[1]

    def pair(self, low: np.ndarray, high: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """Derivatives of the penalty of a quantity with margins `low` above one limit, `high` below another."""
        slope, bend = self.derivatives(np.array((low, high)))
        return slope[0] - slope[1], bend[0] + bend[1]
