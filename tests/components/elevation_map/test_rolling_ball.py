"""A ball at its lowest centre over the middle of a cell clears every column of the map, and touches one."""

import numpy as np
import pytest

from surefoot.components.elevation_map.rolling_ball import RollingBall


def lowest(height, cell, radius, i, j):
    """By geometry: the least height at which the centre is a radius from the nearest point of every column."""
    least = -np.inf
    for (k, l), z in np.ndenumerate(height):
        gap = cell * np.hypot(max(abs(k - i) - 0.5, 0.0), max(abs(l - j) - 0.5, 0.0))
        if gap < radius and not np.isnan(z):
            least = max(least, z + np.sqrt(radius**2 - gap**2))
    return least


@pytest.mark.parametrize(("radius", "cell"), [(0.0465, 0.02), (0.0304, 0.02), (0.02, 0.02), (0.01, 0.03)])
def test_the_lowest_centre_is_the_geometrys(radius, cell):
    height = 0.05 * np.random.default_rng(3).normal(size=(9, 8))
    height[2:5, 3] = np.nan
    found = RollingBall(radius, cell).lowest_centre(height)
    for i, j in np.ndindex(height.shape):
        assert found[i, j] == pytest.approx(lowest(height, cell, radius, i, j), abs=1e-12)


def test_unknown_ground_is_no_obstacle():
    ball = RollingBall(0.0465, 0.02)
    assert (ball.lowest_centre(np.full((9, 9), np.nan)) == -np.inf).all()
    height = np.full((9, 9), np.nan)
    height[4, 4] = 0.3
    found = ball.lowest_centre(height)
    assert found[4, 4] == pytest.approx(0.3465)
    assert found[4, 6] == pytest.approx(0.3 + np.sqrt(0.0465**2 - 0.03**2))
    assert found[4, 7] == -np.inf
