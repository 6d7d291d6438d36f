"""Contact-force limits along the surface normal."""

from __future__ import annotations

import numpy as np

from surefoot.components.ocp.quadratic_model import QuadraticModel
from surefoot.components.ocp.relaxed_barrier import RelaxedBarrier
from surefoot.components.ocp.term import Nodes


class ForceLimits:
    """f_min <= f_n <= f_max [N] for every stance leg; Table I: mu 1, delta 0.5 N."""

    name = "force_limits"

    def __init__(self, barrier: RelaxedBarrier, minimum_n: float, maximum_n: float):
        self._barrier, self._minimum, self._maximum = barrier, minimum_n, maximum_n

    def value(self, nodes: Nodes) -> np.ndarray:
        low, high = self._margins(nodes)
        stance = nodes.reference.contact[: nodes.N]
        return (stance * (self._barrier.value(low) + self._barrier.value(high))).sum(axis=1)

    def add(self, nodes: Nodes, model: QuadraticModel) -> None:
        stance, normal = nodes.reference.contact[: nodes.N], nodes.reference.normal_W
        slope, bend = self._barrier.pair(*self._margins(nodes))
        model.u_slope += (stance * slope)[..., None] * normal
        model.u_bend += (stance * bend)[..., None, None] * (normal[:, None] * normal)

    def violation(self, nodes: Nodes) -> float:
        margin = np.minimum(*self._margins(nodes))
        return max(0.0, -float((nodes.reference.contact[: nodes.N] * margin).min()))

    def _margins(self, nodes: Nodes) -> tuple[np.ndarray, np.ndarray]:
        along = nodes.iterate.force_W @ nodes.reference.normal_W
        return along - self._minimum, self._maximum - along
