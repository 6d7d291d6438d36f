"""Eq. (3): the contact force stays in the friction cone about the surface normal."""

from __future__ import annotations

import numpy as np

from surefoot.components.ocp.relaxed_barrier import RelaxedBarrier
from surefoot.components.ocp.term import Nodes, add_force_rows


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

    def add(self, nodes: Nodes, H: np.ndarray, g: np.ndarray) -> None:
        h, tangential, length, normal = self._cone(nodes)
        stance = nodes.reference.contact[: nodes.N]
        slope = self._friction * normal - tangential / length[..., None]
        first = (stance * self._barrier.gradient(h))[..., None]
        second = (stance * self._barrier.hessian(h))[..., None, None]
        # Gauss-Newton, and the convex part of the cone's own curvature.
        across = np.eye(3) - np.outer(normal, normal)
        unit = tangential / length[..., None]
        curvature = (across - unit[..., :, None] * unit[..., None, :]) / length[..., None, None]
        bend = second * (slope[..., :, None] * slope[..., None, :]) - first[..., None] * curvature
        add_force_rows(nodes, first * slope, bend, H, g)

    def violation(self, nodes: Nodes) -> float:
        h, *_ = self._cone(nodes)
        return float(max(0.0, -h[nodes.reference.contact[: nodes.N]].min(initial=0.0)))

    def _cone(self, nodes: Nodes):
        force, normal = nodes.iterate.force_W, nodes.reference.normal_W
        along = force @ normal
        tangential = force - along[..., None] * normal
        length = np.sqrt((tangential**2).sum(axis=-1) + self._reg)
        return self._friction * along - length, tangential, length, normal
