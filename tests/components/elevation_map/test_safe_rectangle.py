"""The region of eq. (4) is the largest rectangle of safe cells around a foothold: found by trying all of them."""

import numpy as np
import pytest

from surefoot.components.elevation_map.safe_rectangle import SafeRectangle


def largest(safe, cell):
    """Cells of the largest rectangle of at least 2x2 that contains a cell, by trying every one; else 1."""
    n, m = safe.shape
    best = 1
    for i0 in range(cell[0] + 1):
        for i1 in range(cell[0], n):
            for j0 in range(cell[1] + 1):
                for j1 in range(cell[1], m):
                    if i1 > i0 and j1 > j0 and safe[i0 : i1 + 1, j0 : j1 + 1].all():
                        best = max(best, (i1 - i0 + 1) * (j1 - j0 + 1))
    return best


def cells(rectangle):
    (i0, j0), (i1, j1) = rectangle.first, rectangle.last
    return slice(i0, i1 + 1), slice(j0, j1 + 1)


@pytest.mark.parametrize("density", [0.3, 0.6, 0.8, 0.95])
def test_no_rectangle_of_safe_cells_is_larger(density):
    rng = np.random.default_rng(int(100 * density))
    for _ in range(50):
        safe = rng.random((9, 7)) < density
        cell = int(rng.integers(9)), int(rng.integers(7))
        safe[cell] = True
        found = SafeRectangle.around(safe, cell)
        inside = safe[cells(found)]
        assert inside.all() and inside.size == largest(safe, cell)
        assert found.first[0] <= cell[0] <= found.last[0] and found.first[1] <= cell[1] <= found.last[1]


def test_the_whole_heightmap_when_all_is_safe():
    for cell in ((0, 0), (7, 7), (14, 3)):
        assert SafeRectangle.around(np.ones((15, 15), bool), cell) == SafeRectangle((0, 0), (14, 14))


def test_a_strip_of_one_cell_is_left_for_a_smaller_square_or_for_the_cell_alone():
    strip = np.zeros((15, 15), bool)
    strip[7] = True
    assert SafeRectangle.around(strip, (7, 3)) == SafeRectangle((7, 3), (7, 3))
    strip[8, 3:5] = True
    assert SafeRectangle.around(strip, (7, 3)) == SafeRectangle((7, 3), (8, 4))


def test_of_equally_large_ones_the_squarest_and_then_the_first():
    safe = np.zeros((15, 15), bool)
    safe[7:9, 2:8] = True  # 2 x 6
    safe[7:10, 4:8] = True  # 3 x 4, which holds as many
    assert SafeRectangle.around(safe, (7, 7)) == SafeRectangle((7, 4), (9, 7))
    assert SafeRectangle.around(safe.T, (7, 7)) == SafeRectangle((4, 7), (7, 9))
    square = np.zeros((15, 15), bool)
    square[6:9, 7] = square[6:9, 8] = True
    square[7:9, 6:9] = True  # 2 x 3 along y from x = 7, and 3 x 2 along x from 6
    assert SafeRectangle.around(square, (7, 7)) == SafeRectangle((6, 7), (8, 8))


def test_half_spaces_hold_inside_the_cells_outer_borders_and_nowhere_else():
    A, b = SafeRectangle((2, 5), (4, 10)).half_spaces(np.array([1.0, -2.0]), 0.02)
    np.testing.assert_allclose(np.linalg.norm(A, axis=1), 1.0)
    np.testing.assert_array_equal(A[:, 2], 0.0)
    rng = np.random.default_rng(0)
    points = np.column_stack([rng.uniform(1.0, 1.2, 500), rng.uniform(-2.0, -1.7, 500), rng.normal(size=500)])
    cell = np.round((points[:, :2] - [1.0, -2.0]) / 0.02)
    inside = (cell >= [2, 5]).all(axis=1) & (cell <= [4, 10]).all(axis=1)
    assert 20 < inside.sum() < 480
    np.testing.assert_array_equal((points @ A.T + b >= 0.0).all(axis=1), inside)
