"""Limits of joint positions and velocities."""

from __future__ import annotations

import numpy as np

from surefoot.components.ocp.layout import JOINTS
from surefoot.components.ocp.quadratic_model import QuadraticModel
from surefoot.components.ocp.relaxed_barrier import RelaxedBarrier
from surefoot.components.ocp.term import Nodes


class JointPositionLimits:
    """q_min <= q <= q_max [rad]; Table I: mu 0.1, delta 0.01 rad."""

    name = "joint_position"

    def __init__(self, barrier: RelaxedBarrier, lower: np.ndarray, upper: np.ndarray):
        self._barrier, self._lower, self._upper = barrier, lower.ravel(), upper.ravel()

    def value(self, nodes: Nodes) -> np.ndarray:
        low, high = self._margins(nodes)
        return (self._barrier.value(low) + self._barrier.value(high)).sum(axis=1)

    def add(self, nodes: Nodes, model: QuadraticModel) -> None:
        slope, bend = self._barrier.pair(*self._margins(nodes))
        model.x_slope[:-1, JOINTS] += slope
        model.x_bend[:-1, JOINTS] += bend

    def violation(self, nodes: Nodes) -> float:
        return max(0.0, -float(np.minimum(*self._margins(nodes)).min()))

    def _margins(self, nodes: Nodes) -> tuple[np.ndarray, np.ndarray]:
        q = nodes.iterate.q[: nodes.N].reshape(nodes.N, 12)
        return q - self._lower, self._upper - q


class JointVelocityLimits:
    """|dq| <= limit [rad/s]; Table I: mu 0.1, delta 0.1 rad/s."""

    name = "joint_velocity"

    def __init__(self, barrier: RelaxedBarrier, limit: float):
        self._barrier, self._limit = barrier, limit

    def value(self, nodes: Nodes) -> np.ndarray:
        dq = nodes.iterate.v[:, 6:]
        return (self._barrier.value(self._limit - dq) + self._barrier.value(self._limit + dq)).sum(axis=1)

    def add(self, nodes: Nodes, model: QuadraticModel) -> None:
        dq = nodes.iterate.v[:, 6:]
        slope, bend = self._barrier.pair(self._limit + dq, self._limit - dq)
        model.dq_slope += slope
        model.dq_bend += bend

    def violation(self, nodes: Nodes) -> float:
        return float(max(0.0, np.abs(nodes.iterate.v[:, 6:]).max() - self._limit))
