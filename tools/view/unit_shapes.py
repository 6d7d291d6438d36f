"""The shapes of a drawing in size one, as triangles: a profile that is turned about the vertical axis."""

from __future__ import annotations

import numpy as np

from surefoot.tools.view.drawing import Kind

_ROUND = 24  # facets of what is round
_SPHERE_RINGS = 12
_CORNER = np.sqrt(0.5)  # from the middle of a square of side one


def unit_shape(kind: Kind) -> tuple[np.ndarray, np.ndarray]:
    """(v, 3) vertices and (f, 3) faces, counterclockwise from outside, of a shape that is 1 wide and 1 high.

    The middle of a box, a cylinder, a sphere or a square is the origin; a cone stands on it by its tip. Where the
    surface has edges no triangles share a corner: light is then reckoned for each by itself, and a browser draws
    what is round and what is not with one shader, of which each takes long to build without a graphics card.
    """
    if kind == "box":
        return _edged(_turned([(0.0, -0.5), (_CORNER, -0.5), (_CORNER, 0.5), (0.0, 0.5)], 4))
    if kind == "square":
        return _edged(_turned([(_CORNER, 0.0), (0.0, 0.0)], 4))
    if kind == "cylinder":
        return _edged(_turned([(0.0, -0.5), (0.5, -0.5), (0.5, 0.5), (0.0, 0.5)], _ROUND))
    if kind == "cone":
        return _turned([(0.0, 0.0), (0.5, 1.0), (0.0, 1.0)], _ROUND)
    latitude = np.pi * (np.arange(1, _SPHERE_RINGS) / _SPHERE_RINGS - 0.5)
    rings = zip(0.5 * np.cos(latitude), 0.5 * np.sin(latitude), strict=True)
    return _turned([(0.0, -0.5), *rings, (0.0, 0.5)], _ROUND)


def _turned(profile: list[tuple[float, float]], facets: int) -> tuple[np.ndarray, np.ndarray]:
    """The surface that a profile leaves when it is turned about z; corners of a square lie on its diagonals.

    Args:
        profile: distances from the axis and heights, upwards on the outside.
        facets: in a turn.
    """
    angle = 2.0 * np.pi * (np.arange(facets) + 0.5) / facets
    r, z = np.array(profile).T
    ring = np.stack([np.cos(angle), np.sin(angle)], axis=1)
    vertices = np.concatenate(
        [np.c_[radius * ring, np.full(facets, height)] for radius, height in zip(r, z, strict=True)]
    )
    here = np.arange(facets)
    after = (here + 1) % facets
    faces = []
    for low in range(len(profile) - 1):
        a, b = low * facets + here, low * facets + after
        c, d = b + facets, a + facets
        if r[low] > 0.0:
            faces.append(np.stack([a, b, c if r[low + 1] > 0.0 else d], axis=1))
        if r[low + 1] > 0.0:
            faces.append(np.stack([a, c, d], axis=1))
    return vertices, np.concatenate(faces)


def _edged(surface: tuple[np.ndarray, np.ndarray]) -> tuple[np.ndarray, np.ndarray]:
    """The same surface with three vertices for each face."""
    vertices, faces = surface
    return vertices[faces].reshape(-1, 3), np.arange(faces.size).reshape(-1, 3)
