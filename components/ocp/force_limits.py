"""Contact-force limits along the surface normal."""

from __future__ import annotations

import numpy as np

from surefoot.components.ocp.relaxed_barrier import RelaxedBarrier
from surefoot.components.ocp.term import Nodes, add_force_rows


class ForceLimits:
    """f_min <= f_n <= f_max [N] for every stance leg; Table I: mu 1, delta 0.5 N."""

    name = "force_limits"

    def __init__(self, barrier: RelaxedBarrier, minimum_n: float, maximum_n: float):
        self._barrier, self._minimum, self._maximum = barrier, minimum_n, maximum_n

    def value(self, nodes: Nodes) -> np.ndarray:
        low, high = self._margins(nodes)
        stance = nodes.reference.contact[: nodes.N]
        return (stance * (self._barrier.value(low) + self._barrier.value(high))).sum(axis=1)

    def add(self, nodes: Nodes, H: np.ndarray, g: np.ndarray) -> None:
        low, high = self._margins(nodes)
        stance, normal = nodes.reference.contact[: nodes.N], nodes.reference.normal_W
        slope = stance * (self._barrier.gradient(low) - self._barrier.gradient(high))
        bend = stance * (self._barrier.hessian(low) + self._barrier.hessian(high))
        add_force_rows(nodes, slope[..., None] * normal, bend[..., None, None] * np.outer(normal, normal), H, g)

    def violation(self, nodes: Nodes) -> float:
        low, high = self._margins(nodes)
        return float(max(0.0, -np.minimum(low, high)[nodes.reference.contact[: nodes.N]].min(initial=0.0)))

    def _margins(self, nodes: Nodes) -> tuple[np.ndarray, np.ndarray]:
        along = nodes.iterate.force_W @ nodes.reference.normal_W
        return along - self._minimum, self._maximum - along
