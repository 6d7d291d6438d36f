"""What there is to draw, as plain arrays in the world: no browser is needed to make or to test it."""

from __future__ import annotations

from dataclasses import dataclass
from functools import lru_cache
from typing import Literal

import numpy as np

Rgb = tuple[int, int, int]
"""A colour, each part from 0 to 255."""

Kind = Literal["box", "cylinder", "sphere", "cone", "square"]
"""Shapes of size one: a cone stands on its tip and opens along z, a square lies flat, a cylinder is along z."""


@dataclass(frozen=True)
class Shapes:
    """Copies of one shape.

    Attributes:
        kind: of which shape.
        p_W: (n, 3) centres, of a cone its tip [m].
        quat_W: (n, 4) orientations (w, x, y, z).
        size_m: (n, 3) full lengths along their own axes [m].
        rgb: (n, 3) colours, uint8.
        opacity: 1 is solid.
    """

    kind: Kind
    p_W: np.ndarray
    quat_W: np.ndarray
    size_m: np.ndarray
    rgb: np.ndarray
    opacity: float = 1.0


@dataclass(frozen=True)
class Mesh:
    """One surface: vertices (v, 3) in the world [m], faces (f, 3) of their numbers, seen from both sides."""

    vertices_W: np.ndarray
    faces: np.ndarray
    rgb: Rgb
    opacity: float = 1.0


@dataclass(frozen=True)
class Lines:
    """Segments: (n, 2, 3) from where to where in the world [m], and how thick [m]."""

    points_W: np.ndarray
    rgb: Rgb
    thickness_m: float = 0.004


@dataclass(frozen=True)
class Arrows:
    """Arrows: (n, 2, 3) from tail to tip in the world [m], and how thick [m]."""

    points_W: np.ndarray
    rgb: Rgb
    radius_m: float = 0.006


@dataclass(frozen=True)
class Words:
    """A few words at a point (3,) of the world [m]."""

    p_W: np.ndarray
    text: str


Item = Shapes | Mesh | Lines | Arrows | Words

Drawing = dict[str, Item]
"""By name: the layer, a slash, and what it is in there."""

UPRIGHT = (1.0, 0.0, 0.0, 0.0)
"""The quaternion of what is not turned."""


def path(points_W: np.ndarray) -> np.ndarray:
    """(n - 1, 2, 3) segments of the line through points (n, 3)."""
    return np.stack([points_W[:-1], points_W[1:]], axis=1)


@lru_cache(maxsize=256)
def rows(row: tuple[float, ...], n: int) -> np.ndarray:
    """(n, k) the same row over and over; the same array each time: what has not changed is not even compared."""
    return np.broadcast_to(np.array(row), (n, len(row)))


@lru_cache(maxsize=256)
def colours(rgb: Rgb, n: int) -> np.ndarray:
    """(n, 3) one colour over and over, uint8; the same array each time."""
    return np.broadcast_to(np.array(rgb, np.uint8), (n, 3))


def level(kind: Kind, p_W: np.ndarray, size_m: tuple[float, ...], rgb: np.ndarray) -> Shapes:
    """Shapes of one size at points (n, 3) that are not turned."""
    n = len(p_W)
    return Shapes(kind, p_W, rows(UPRIGHT, n), rows(size_m, n), rgb)
