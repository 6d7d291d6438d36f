"""Eq. (5): the centre of mass stays inside the polygon of the legs that do not probe."""

from __future__ import annotations

import numpy as np

from surefoot.components.ocp.quadratic_model import QuadraticModel
from surefoot.components.ocp.relaxed_barrier import RelaxedBarrier
from surefoot.components.ocp.term import Nodes
from surefoot.config.robot import ANTICLOCKWISE

_CORNERS = np.array([[leg for leg in ANTICLOCKWISE if leg != out] for out in range(4)])
_NEXT = np.roll(_CORNERS, -1, axis=1)


class SupportPolygon:
    """A_s r_b + b_s - alpha >= 0 [m], r_b the centre of mass along gravity; Table I: mu 100, delta 0.02 m.

    The polygon is that of the three other feet as the reference places them, its normals of unit length, so
    that the barrier is in metres. The feet stand (v = 0 by eq. (3)): only the centre of mass moves in it.
    """

    name = "support_polygon"

    def __init__(self, barrier: RelaxedBarrier):
        self._barrier = barrier

    def value(self, nodes: Nodes) -> np.ndarray:
        active, h, _ = self._margins(nodes)
        return active * self._barrier.value(h).sum(axis=1)

    def add(self, nodes: Nodes, model: QuadraticModel) -> None:
        if not (nodes.reference.support_leg >= 0).any():
            return
        active, h, normals = self._margins(nodes)
        slope, bend = self._barrier.derivatives(h)
        inward = (active[:, None, None] * normals).swapaxes(1, 2)
        model.place_slope[:, 4, :2] += (inward @ slope[..., None])[..., 0]
        model.place_bend[:, 4, :2, :2] += inward @ (bend[..., None] * normals)

    def violation(self, nodes: Nodes) -> float:
        if not (nodes.reference.support_leg >= 0).any():
            return 0.0
        active, h, _ = self._margins(nodes)
        return float(max(0.0, -h[active].min(initial=0.0)))

    def _margins(self, nodes: Nodes) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
        """Active nodes (N,), h (N, 3) and inward unit normals (N, 3, 2)."""
        reference, N = nodes.reference, nodes.N
        left_out = reference.support_leg[:N]
        active = left_out >= 0
        feet, first = reference.p_WF.reshape(-1, 3), 4 * np.arange(N)[:, None]
        out = np.maximum(left_out, 0)
        corners = feet.take(first + _CORNERS.take(out, axis=0), axis=0)
        edges = feet.take(first + _NEXT.take(out, axis=0), axis=0) - corners
        x, y = edges[..., 0], edges[..., 1]
        normals = np.stack((-y, x), axis=-1) / np.sqrt(x * x + y * y)[..., None]
        offset = normals * (nodes.linear.com_W[:, None, :2] - corners[..., :2])
        return active, offset[..., 0] + offset[..., 1] - reference.support_margin_m, normals
