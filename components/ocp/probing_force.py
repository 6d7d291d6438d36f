"""Eq. (6): while it probes, a foot presses with the asked force."""

from __future__ import annotations

import numpy as np

from surefoot.components.ocp.quadratic_model import QuadraticModel
from surefoot.components.ocp.relaxed_barrier import RelaxedBarrier
from surefoot.components.ocp.term import Nodes


class ProbingForce:
    """f_i = f_i^p as two inequalities, f - f^p >= 0 and f^p - f >= 0, each component; Table I: mu = delta = 0.7.

    Near zero the pair is about (mu / delta^2) e^2: soft on purpose, since eq. (5) opposes it.
    """

    name = "probing_force"

    def __init__(self, barrier: RelaxedBarrier):
        self._barrier = barrier

    def value(self, nodes: Nodes) -> np.ndarray:
        active, error = self._error(nodes)
        both = self._barrier.value(error) + self._barrier.value(-error)
        return (active[..., None] * both).sum(axis=(1, 2))

    def add(self, nodes: Nodes, model: QuadraticModel) -> None:
        if not (nodes.reference.probe_leg >= 0).any():
            return
        active, error = self._error(nodes)
        slope, bend = self._barrier.pair(error, -error)
        model.u_slope += active[..., None] * slope
        model.u_bend += (active[..., None] * bend)[..., None] * np.eye(3)

    def violation(self, nodes: Nodes) -> float:
        if not (nodes.reference.probe_leg >= 0).any():
            return 0.0
        active, error = self._error(nodes)
        return float(np.abs(error * active[..., None]).max(initial=0.0))

    def _error(self, nodes: Nodes) -> tuple[np.ndarray, np.ndarray]:
        reference, N = nodes.reference, nodes.N
        active = (reference.probe_leg[:N, None] == np.arange(4)) & reference.contact[:N]
        return active, nodes.iterate.force_W - reference.probe_force_W[:N, None]
