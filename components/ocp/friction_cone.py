"""Eq. (3): the contact force stays in the friction cone about the surface normal."""

from __future__ import annotations

import numpy as np

from surefoot.components.ocp.quadratic_model import QuadraticModel
from surefoot.components.ocp.relaxed_barrier import RelaxedBarrier
from surefoot.components.ocp.term import Nodes

_EYE3, _ONES3 = np.eye(3), np.ones(3)


class FrictionCone:
    """h = mu_c f_n - sqrt(|f_t|^2 + reg) >= 0 [N] for every stance leg; Table I: mu 10, delta 0.1 N.

    `reg` makes the cone smooth at its tip, and with that asks for f_n >= sqrt(reg) / mu_c.
    """

    name = "friction_cone"

    def __init__(self, barrier: RelaxedBarrier, friction: float, regularisation_n2: float):
        self._barrier, self._friction, self._reg = barrier, friction, regularisation_n2

    def value(self, nodes: Nodes) -> np.ndarray:
        h, *_ = self._cone(nodes)
        return (nodes.reference.contact[: nodes.N] * self._barrier.value(h)).sum(axis=1)

    def add(self, nodes: Nodes, model: QuadraticModel) -> None:
        h, tangential, length, normal = self._cone(nodes)
        stance = nodes.reference.contact[: nodes.N]
        first, second = self._barrier.derivatives(h)
        first, second = stance * first, stance * second
        unit = tangential / length[..., None]
        slope = self._friction * normal - unit
        model.u_slope += first[..., None] * slope
        # Gauss-Newton, and the convex part of the cone's own curvature, (across - unit unit') / length.
        across = _EYE3 - normal[:, None] * normal
        inward = (first / length)[..., None]
        model.u_bend += (second[..., None] * slope)[..., None] * slope[..., None, :]
        model.u_bend += (inward * unit)[..., None] * unit[..., None, :]
        model.u_bend -= inward[..., None] * across

    def violation(self, nodes: Nodes) -> float:
        h, *_ = self._cone(nodes)
        return max(0.0, -float((nodes.reference.contact[: nodes.N] * h).min()))

    def _cone(self, nodes: Nodes):
        force, normal = nodes.iterate.force_W, nodes.reference.normal_W
        along = force @ normal
        tangential = force - along[..., None] * normal
        # Not |f|^2 - f_n^2, which loses digits where f_t is small.
        length = np.sqrt((tangential * tangential) @ _ONES3 + self._reg)
        return self._friction * along - length, tangential, length, normal
