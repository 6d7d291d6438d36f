"""What carries the robot: the support polygon with its margin, and the centre of mass above it."""

from __future__ import annotations

import numpy as np

from surefoot.bus.messages import MotionReference
from surefoot.components.fsm.support_triangle import SupportTriangle
from surefoot.config.robot import ANTICLOCKWISE
from surefoot.tools.view.drawing import Drawing, Lines, Mesh, colours, level
from surefoot.tools.view.palette import COM, MARGIN, SUPPORT

_ABOVE_M = 0.006  # the polygon lies that far over the ground, to be seen
_COM_M = 0.035


class Support:
    """What carries the robot, for as long as the same feet do: the polygon is made once."""

    def __init__(self, reference: MotionReference, foot_radius_m: float, margin_m: float):
        """Of the feet that the state machine counts on.

        Args:
            reference: of the state machine.
            foot_radius_m: the ground lies so far below the feet's centres.
            margin_m: how far inside the centre of mass is to be.
        """
        self._told = _told(reference, margin_m)
        feet = [leg for leg in ANTICLOCKWISE if leg != reference.leg]
        corners = reference.p_WF[feet] - [0.0, 0.0, foot_radius_m - _ABOVE_M]
        self._plane = _plane(corners)
        self._polygon: Drawing = {
            "support/area": Mesh(corners, _fan(len(corners)), SUPPORT, 0.25),
            "support/edge": Lines(_ring(corners), SUPPORT),
        }
        if reference.leg >= 0:
            triangle = SupportTriangle(reference.p_WF, reference.leg)
            inner = _inset(triangle, margin_m)
            if len(inner):
                self._polygon["support/margin"] = Lines(_ring(self._on_plane(inner)), MARGIN, 0.003)

    def holds(self, reference: MotionReference, margin_m: float) -> bool:
        """Whether it is this reference's too."""
        return _told(reference, margin_m) == self._told

    def draw(self, com_W: np.ndarray) -> Drawing:
        """Polygon and margin, and the centre of mass (3,) [m] with its plumb line."""
        below = self._on_plane(com_W[None, :2])
        return self._polygon | {
            "com/ball": level("sphere", com_W[None], (_COM_M,) * 3, colours(COM, 1)),
            "com/plumb": Lines(np.stack([com_W[None], below], axis=1), COM),
            "com/foot": level("cylinder", below, (_COM_M, _COM_M, 0.004), colours(COM, 1)),
        }

    def _on_plane(self, points: np.ndarray) -> np.ndarray:
        """(n, 3) points (n, 2) on the plane of the feet [m]."""
        return np.column_stack([points, points @ self._plane[:2] + self._plane[2]])


def _told(reference: MotionReference, margin_m: float) -> tuple:
    return reference.p_WF.tobytes(), reference.leg, margin_m


def _inset(triangle: SupportTriangle, margin_m: float) -> np.ndarray:
    """(3, 2) the triangle's corners moved inwards, or (0, 2) where nothing of it is left."""
    offsets = (triangle.normals * triangle.corners).sum(axis=1) + margin_m
    inner = np.array(
        [np.linalg.solve(triangle.normals[[edge - 1, edge]], offsets[[edge - 1, edge]]) for edge in range(3)]
    )
    return inner if triangle.margin(inner.mean(axis=0)) > margin_m else inner[:0]


def _plane(corners: np.ndarray) -> np.ndarray:
    """(3,) of the plane through the corners (n, 3): slopes along x and y, and its height at the origin [m]."""
    terms = np.column_stack([corners[:, :2], np.ones(len(corners))])
    return np.linalg.lstsq(terms, corners[:, 2], rcond=None)[0]


def _fan(corners: int) -> np.ndarray:
    """(corners - 2, 3) triangles that fill a convex polygon."""
    return np.array([(0, each, each + 1) for each in range(1, corners - 1)])


def _ring(corners: np.ndarray) -> np.ndarray:
    """(n, 2, 3) the edges of a polygon (n, 3)."""
    return np.stack([corners, np.roll(corners, -1, axis=0)], axis=1)
