"""Eq. (4): a foot touches down inside its convex region."""

from __future__ import annotations

import numpy as np

from surefoot.components.ocp.quadratic_model import QuadraticModel
from surefoot.components.ocp.relaxed_barrier import RelaxedBarrier
from surefoot.components.ocp.term import Nodes

LANDING_SHARE = 0.2
"""Eq. (4) acts over this last share of a swing too: the foot comes down inside its region, not towards it."""


class FootPlacement:
    """A_i p_i + b_i >= 0 [m] where a region is active; Table I: mu 0.1, delta 0.005 m."""

    name = "foot_placement"

    def __init__(self, barrier: RelaxedBarrier):
        self._barrier = barrier

    def value(self, nodes: Nodes) -> np.ndarray:
        active, h = self._margins(nodes)
        return (active * self._barrier.value(h).sum(axis=2)).sum(axis=1)

    def add(self, nodes: Nodes, model: QuadraticModel) -> None:
        if not nodes.reference.region_active.any():
            return
        active, h = self._margins(nodes)
        A = nodes.reference.region_a
        slope, bend = self._barrier.derivatives(h)
        active = active[..., None]
        model.place_slope[:, :4] += (A.swapaxes(1, 2) @ (active * slope)[..., None])[..., 0]
        model.place_bend[:, :4] += A.swapaxes(1, 2) @ ((active * bend)[..., None] * A)

    def violation(self, nodes: Nodes) -> float:
        if not nodes.reference.region_active.any():
            return 0.0
        active, h = self._margins(nodes)
        return float(max(0.0, -h[active].min(initial=0.0)))

    def _margins(self, nodes: Nodes) -> tuple[np.ndarray, np.ndarray]:
        reference, N = nodes.reference, nodes.N
        h = (reference.region_a @ nodes.linear.p_WF[..., None])[..., 0] + reference.region_b
        return reference.region_active[:N], h
