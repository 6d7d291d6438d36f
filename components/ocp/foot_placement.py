"""Eq. (4): a foot touches down inside its convex region."""

from __future__ import annotations

import numpy as np

from surefoot.components.ocp.relaxed_barrier import RelaxedBarrier
from surefoot.components.ocp.term import Nodes, add_foot_rows


class FootPlacement:
    """A_i p_i + b_i >= 0 [m] where a region is active; Table I: mu 0.1, delta 0.005 m."""

    name = "foot_placement"

    def __init__(self, barrier: RelaxedBarrier):
        self._barrier = barrier

    def value(self, nodes: Nodes) -> np.ndarray:
        active, h = self._margins(nodes)
        return (active * self._barrier.value(h).sum(axis=2)).sum(axis=1)

    def add(self, nodes: Nodes, H: np.ndarray, g: np.ndarray) -> None:
        active, h = self._margins(nodes)
        if not active.any():
            return
        A = nodes.reference.region_a
        slope = active[..., None] * self._barrier.gradient(h)
        bend = active[..., None] * self._barrier.hessian(h)
        along = (A.swapaxes(1, 2) @ slope[..., None])[..., 0]
        add_foot_rows(nodes, along, A.swapaxes(1, 2) @ (bend[..., None] * A), H, g)

    def violation(self, nodes: Nodes) -> float:
        active, h = self._margins(nodes)
        return float(max(0.0, -h[active].min(initial=0.0)))

    def _margins(self, nodes: Nodes) -> tuple[np.ndarray, np.ndarray]:
        reference, N = nodes.reference, nodes.N
        h = (reference.region_a @ nodes.linear.p_WF[..., None])[..., 0] + reference.region_b
        return reference.region_active[:N], h
