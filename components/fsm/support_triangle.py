"""The triangle of the three feet that carry the robot while the fourth is moved or probes."""

from __future__ import annotations

import numpy as np

from surefoot.config.robot import ANTICLOCKWISE

_OTHERS = np.array([[other for other in ANTICLOCKWISE if other != leg] for leg in range(4)])
_NEXT = np.array([1, 2, 0])  # corner after each
_QUARTER_TURN = np.array([-1.0, 1.0])  # of a vector whose parts have changed places


class SupportTriangle:
    """Triangle over the feet other than `leg`, along gravity.

    Attributes:
        corners: (3, 2) anticlockwise, in the world [m].
        normals: (3, 2) inward unit normal of the edge from each corner to the next.
    """

    def __init__(self, p_WF: np.ndarray, leg: int):
        self.corners = np.ascontiguousarray(p_WF[_OTHERS[leg], :2])
        edges = self._edges()
        self.normals = edges[:, ::-1] * _QUARTER_TURN / np.hypot(edges[:, 0], edges[:, 1])[:, None]

    def margin(self, point: np.ndarray) -> float:
        """Distance of a point (2,) from the nearest edge, positive inside [m]."""
        return float(((point - self.corners) * self.normals).sum(axis=1).min())

    def nearest(self, point: np.ndarray, inset: float) -> np.ndarray:
        """The point (2,) of the triangle shrunk by `inset` [m] that is nearest to `point`.

        A triangle that is smaller than the inset shrinks to its incentre.
        """
        offsets = (self.normals * self.corners).sum(axis=1) + min(inset, 0.999 * self._inradius())
        if (self.normals @ point >= offsets).all():
            return point
        inner = [
            np.linalg.solve(self.normals[[before, edge]], offsets[[before, edge]])
            for edge, before in enumerate((2, 0, 1))
        ]
        best, distance = inner[0], np.inf
        for start, end in zip(inner, inner[1:] + inner[:1], strict=True):
            along = end - start
            share = np.clip((point - start) @ along / max(along @ along, 1e-12), 0.0, 1.0)
            candidate = start + share * along
            gap = np.hypot(*(candidate - point))
            if gap < distance:
                best, distance = candidate, gap
        return best

    def _inradius(self) -> float:
        edges = self._edges()
        area = 0.5 * abs(edges[0, 0] * edges[1, 1] - edges[0, 1] * edges[1, 0])
        return 2.0 * area / np.hypot(edges[:, 0], edges[:, 1]).sum()

    def _edges(self) -> np.ndarray:
        """(3, 2) from each corner to the next [m]."""
        return self.corners[_NEXT] - self.corners
