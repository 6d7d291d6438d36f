"""What each foothold has been found to bear, as a soft limit of its foot's normal force."""

from __future__ import annotations

import numpy as np

from surefoot.components.ocp.quadratic_model import QuadraticModel
from surefoot.components.ocp.term import Nodes


def load_limit(certified_n: np.ndarray) -> np.ndarray:
    """(..., 4) limits [N] of footholds certified for loads (..., 4) [N]; infinite where that is 0: not known."""
    return np.where(certified_n > 0.0, certified_n, np.inf)


class CertifiedLoad:
    """1/2 w max(0, f_n - c)^2 for every stance leg whose foothold is certified for c [N]; not in the paper.

    Soft, unlike the robot's own limit: when a foot is lost the other three have to carry the robot whatever they
    are certified for. A plan that may not ask it of them lets the base sink and tip.
    """

    name = "certified_load"

    def __init__(self, weight: float):
        """`weight`: w [1/N^2]."""
        self._weight = weight

    def value(self, nodes: Nodes) -> np.ndarray:
        return 0.5 * self._weight * (self._excess(nodes) ** 2).sum(axis=1)

    def add(self, nodes: Nodes, model: QuadraticModel) -> None:
        if not np.isfinite(nodes.reference.force_max_n).any():
            return
        excess, normal = self._excess(nodes), nodes.reference.normal_W
        model.u_slope += (self._weight * excess)[..., None] * normal
        model.u_bend += (self._weight * (excess > 0.0))[..., None, None] * (normal[:, None] * normal)

    def violation(self, nodes: Nodes) -> float:
        return float(self._excess(nodes).max(initial=0.0))

    def _excess(self, nodes: Nodes) -> np.ndarray:
        """(N, 4) normal force above the certificate [N]."""
        reference, N = nodes.reference, nodes.N
        over = nodes.iterate.force_W @ reference.normal_W - reference.force_max_n[:N]
        return np.maximum(over, 0.0) * reference.contact[:N]
