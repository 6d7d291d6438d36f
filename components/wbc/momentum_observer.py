"""External wrench at the centre of mass, from the momentum the known forces do not explain."""

from __future__ import annotations

import numpy as np

from surefoot.components.memory import Memory
from surefoot.config.robot import GRAVITY
from surefoot.config.wbc import Wbc


class MomentumObserver:
    """First-order observer of centroidal momentum, after Focchi et al. 2020 (reference [8] of the paper).

        d(h_hat)/dt = G f - (m g, 0) + w,    w = K (h - h_hat)

    w tends to the wrench that the model does not know of with the time constant 1/K: a payload, a pull on the
    trunk, torque lost in the joints. While a foot is in the air or on ground that is not trusted it is frozen:
    to it a sinking foot looks like a push.

    Attributes:
        wrench_W: (6,) external force and moment about the centre of mass, within their limits [N, N m].
    """

    memory = Memory("wrench_W", "_raw", "_explained")

    def __init__(self, settings: Wbc, mass: float):
        weight = mass * GRAVITY
        self._gain = settings.observer_gain
        self._limit = np.repeat([settings.observer_force_share * weight, settings.observer_moment_max], 3)
        self._gravity = np.array([0.0, 0.0, -weight, 0.0, 0.0, 0.0])
        self._raw = np.zeros(6)
        self._explained: np.ndarray | None = None
        self.wrench_W = np.zeros(6)

    def update(self, momentum_W: np.ndarray, contact_wrench_W: np.ndarray, dt: float) -> None:
        """Take in one cycle, by an implicit step.

        Args:
            momentum_W: (6,) centroidal momentum, linear and angular [N s, N m s].
            contact_wrench_W: (6,) force and moment of the contact forces since the last cycle [N, N m].
            dt: time since then [s].
        """
        if self._explained is None:
            self._explained = momentum_W - self._raw / self._gain
        known = self._explained + dt * (contact_wrench_W + self._gravity)
        self._raw = self._gain / (1.0 + self._gain * dt) * (momentum_W - known)
        self._explained = momentum_W - self._raw / self._gain
        self.wrench_W = np.clip(self._raw, -self._limit, self._limit)

    def freeze(self) -> None:
        """Keep the wrench; momentum changes until the next update explain themselves."""
        self._explained = None
        self._raw = self.wrench_W.copy()

    def reset(self) -> None:
        """Forget everything: the robot does not balance."""
        self._explained = None
        self._raw = np.zeros(6)
        self.wrench_W = np.zeros(6)
