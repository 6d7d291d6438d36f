"""Eq. (5): the centre of mass stays inside the polygon of the legs that do not probe."""

from __future__ import annotations

import numpy as np

from surefoot.components.ocp.relaxed_barrier import RelaxedBarrier
from surefoot.components.ocp.term import Nodes, X

# Neighbours around the robot, so that three of them in this order enclose the polygon anticlockwise.
_ANTICLOCKWISE = (0, 2, 3, 1)


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

    def add(self, nodes: Nodes, H: np.ndarray, g: np.ndarray) -> None:
        active, h, normals = self._margins(nodes)
        if not active.any():
            return
        rows = normals @ nodes.linear.com_x[:, :2]
        transposed = rows.swapaxes(1, 2)
        slope = active[:, None] * self._barrier.gradient(h)
        bend = active[:, None] * self._barrier.hessian(h)
        g[:, X] += (transposed @ slope[..., None])[..., 0]
        H[:, X, X] += transposed @ (bend[..., None] * rows)

    def violation(self, nodes: Nodes) -> float:
        active, h, _ = self._margins(nodes)
        return float(max(0.0, -h[active].min(initial=0.0)))

    def _margins(self, nodes: Nodes) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
        """Active nodes (N,), h (N, 3) and inward unit normals (N, 3, 2)."""
        reference, N = nodes.reference, nodes.N
        left_out = reference.support_leg[:N]
        active = left_out >= 0
        order = np.array([[leg for leg in _ANTICLOCKWISE if leg != out] for out in range(4)])
        corners = reference.p_WF[:N, :, :2][np.arange(N)[:, None], order[np.maximum(left_out, 0)]]
        edges = np.roll(corners, -1, axis=1) - corners
        normals = np.empty_like(edges)
        normals[..., 0], normals[..., 1] = -edges[..., 1], edges[..., 0]
        normals /= np.sqrt((normals**2).sum(axis=-1, keepdims=True))
        offset = nodes.linear.com_W[:, None, :2] - corners
        return active, (normals * offset).sum(axis=-1) - reference.support_margin_m, normals
