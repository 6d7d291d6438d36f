"""What carries the robot: the support polygon with its margin, and the centre of mass above it."""

from __future__ import annotations

import numpy as np

from surefoot.bus.messages import MotionReference
from surefoot.components.fsm.support_triangle import SupportTriangle
from surefoot.config.robot import ANTICLOCKWISE
from surefoot.tools.view.drawing import Drawing, Lines, Mesh, level
from surefoot.tools.view.palette import COM, MARGIN, SUPPORT

_ABOVE_M = 0.006  # the polygon lies that far over the ground, to be seen
_COM_M = 0.035


def draw_support(reference: MotionReference, com_W: np.ndarray, foot_radius_m: float, margin_m: float) -> Drawing:
    """Polygon, margin, centre of mass and its plumb line.

    Args:
        reference: of the state machine.
        com_W: (3,) centre of mass [m].
        foot_radius_m: the ground lies so far below the feet's centres.
        margin_m: how far inside the centre of mass is to be.
    """
    feet = [leg for leg in ANTICLOCKWISE if leg != reference.leg]
    corners = reference.p_WF[feet] - [0.0, 0.0, foot_radius_m - _ABOVE_M]
    below = np.array([*com_W[:2], _plane_z(corners, com_W[:2])])
    drawing: Drawing = {
        "support/area": Mesh(corners, _fan(len(corners)), SUPPORT, 0.25),
        "support/edge": Lines(_ring(corners), SUPPORT),
        "com/ball": level("sphere", com_W[None], (_COM_M,) * 3, np.array([COM], np.uint8)),
        "com/plumb": Lines(np.array([[com_W, below]]), COM),
        "com/foot": level("cylinder", below[None], (_COM_M, _COM_M, 0.004), np.array([COM], np.uint8)),
    }
    if reference.leg < 0:
        return drawing
    triangle = SupportTriangle(reference.p_WF, reference.leg)
    inner = _inset(triangle, margin_m)
    if len(inner) == 0:
        return drawing
    inner_W = np.column_stack([inner, [_plane_z(corners, corner) for corner in inner]])
    return {**drawing, "support/margin": Lines(_ring(inner_W), MARGIN, 0.003)}


def _inset(triangle: SupportTriangle, margin_m: float) -> np.ndarray:
    """(3, 2) the triangle's corners moved inwards, or (0, 2) where nothing of it is left."""
    offsets = (triangle.normals * triangle.corners).sum(axis=1) + margin_m
    inner = np.array(
        [np.linalg.solve(triangle.normals[[edge - 1, edge]], offsets[[edge - 1, edge]]) for edge in range(3)]
    )
    return inner if triangle.margin(inner.mean(axis=0)) > margin_m else inner[:0]


def _plane_z(corners: np.ndarray, point: np.ndarray) -> float:
    """Height [m] of the plane through the corners (n, 3) at a point (2,)."""
    terms = np.column_stack([corners[:, :2], np.ones(len(corners))])
    return float(np.append(point, 1.0) @ np.linalg.lstsq(terms, corners[:, 2], rcond=None)[0])


def _fan(corners: int) -> np.ndarray:
    """(corners - 2, 3) triangles that fill a convex polygon."""
    return np.array([(0, each, each + 1) for each in range(1, corners - 1)])


def _ring(corners: np.ndarray) -> np.ndarray:
    """(n, 2, 3) the edges of a polygon (n, 3)."""
    return np.stack([corners, np.roll(corners, -1, axis=0)], axis=1)
