"""The relaxed logarithmic barrier that makes a cost of every inequality h >= 0 of Table I."""

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

    def gradient(self, h: np.ndarray) -> np.ndarray:
        """Derivative with respect to h."""
        relaxed = (h - 2.0 * self.delta) / self.delta**2
        return self.mu * np.where(h > self.delta, -1.0 / np.maximum(h, self.delta), relaxed)

    def hessian(self, h: np.ndarray) -> np.ndarray:
        """Second derivative with respect to h, positive everywhere."""
        return self.mu / np.maximum(h, self.delta) ** 2
