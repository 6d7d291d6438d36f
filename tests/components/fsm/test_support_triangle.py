"""The support triangle against plain geometry."""

import numpy as np
import pytest

from surefoot.components.fsm.support_triangle import SupportTriangle

FEET = np.array([[0.24, 0.14, 0.0], [0.24, -0.14, 0.0], [-0.24, 0.14, 0.0], [-0.24, -0.14, 0.0]])


@pytest.mark.parametrize("leg", range(4))
def test_margin_is_positive_inside_and_zero_on_the_diagonal(leg):
    triangle = SupportTriangle(FEET, leg)
    opposite = FEET[3 - leg, :2]
    assert triangle.margin(0.3 * opposite) > 0.02
    assert triangle.margin(np.zeros(2)) == pytest.approx(0.0, abs=1e-12)
    assert triangle.margin(-0.3 * opposite) < -0.02


@pytest.mark.parametrize("leg", range(4))
def test_the_nearest_point_keeps_the_inset_and_is_nearest(leg):
    triangle, inset = SupportTriangle(FEET, leg), 0.05
    rng = np.random.default_rng(leg)
    for wish in rng.uniform(-0.3, 0.3, (20, 2)):
        point = triangle.nearest(wish, inset)
        assert triangle.margin(point) >= inset - 1e-9
        inside = [q for q in rng.uniform(-0.3, 0.3, (400, 2)) if triangle.margin(q) >= inset]
        best = min(np.hypot(*(q - wish)) for q in inside)
        assert np.hypot(*(point - wish)) <= best + 1e-9


def test_a_point_that_is_inside_already_stays():
    triangle = SupportTriangle(FEET, 1)
    centroid = triangle.corners.mean(axis=0)
    np.testing.assert_allclose(triangle.nearest(centroid, 0.03), centroid)


def test_an_inset_larger_than_the_triangle_gives_its_incentre():
    triangle = SupportTriangle(FEET, 0)
    point = triangle.nearest(np.array([1.0, 1.0]), 0.5)
    distances = ((point - triangle.corners) * triangle.normals).sum(axis=1)
    np.testing.assert_allclose(distances, distances[0], atol=1e-3)
