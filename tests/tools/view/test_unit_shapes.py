"""The triangles of the view's shapes enclose what they should."""

import numpy as np
import pytest

from surefoot.tools.view.unit_shapes import unit_shape

_DISC = 0.25 * np.pi  # area of a disc that is 1 wide


@pytest.mark.parametrize(
    "kind, volume, low, high",
    [
        ("box", 1.0, -0.5, 0.5),
        ("cylinder", _DISC, -0.5, 0.5),
        ("sphere", np.pi / 6.0, -0.5, 0.5),
        ("cone", _DISC / 3.0, 0.0, 1.0),
    ],
)
def test_a_solid_has_its_volume_and_looks_outwards(kind, volume, low, high):
    vertices, faces = unit_shape(kind)
    a, b, c = vertices[faces].transpose(1, 0, 2)
    enclosed = np.einsum("ij,ij->i", a, np.cross(b, c)).sum() / 6.0  # Gauss: negative if faces look inwards
    assert enclosed == pytest.approx(volume, rel=0.035)
    assert vertices[:, 2].min() == pytest.approx(low) and vertices[:, 2].max() == pytest.approx(high)
    assert np.abs(vertices[:, :2]).max() == pytest.approx(0.5, abs=0.005)


@pytest.mark.parametrize("kind", ["box", "cylinder", "sphere", "cone", "square"])
def test_no_triangle_is_a_line(kind):
    vertices, faces = unit_shape(kind)
    a, b, c = vertices[faces].transpose(1, 0, 2)
    assert np.linalg.norm(np.cross(b - a, c - a), axis=1).min() > 1e-4


def test_a_solid_is_closed():
    vertices, faces = unit_shape("sphere")
    places = vertices.round(9)[faces]
    edges = [(tuple(p), tuple(q)) for face in places for p, q in zip(face, np.roll(face, -1, axis=0), strict=True)]
    assert sorted(edges) == sorted((q, p) for p, q in edges)


def test_a_square_looks_up():
    vertices, faces = unit_shape("square")
    a, b, c = vertices[faces].transpose(1, 0, 2)
    normals = np.cross(b - a, c - a)
    assert (normals[:, 2] > 0.0).all() and 0.5 * normals[:, 2].sum() == pytest.approx(1.0)
