"""A cell is under the foot's disc exactly if the disc touches it from some point of the middle cell."""

import numpy as np
import pytest

from surefoot.components.elevation_map.foot_disc import FootDisc


@pytest.mark.parametrize(
    ("radius", "cell"), [(0.0265, 0.02), (0.0315, 0.02), (0.02, 0.02), (0.0265, 0.007), (0.03, 0.1), (0.0, 0.02)]
)
def test_the_disc_is_what_a_disc_anywhere_in_the_middle_cell_touches(radius, cell):
    disc = FootDisc(radius, cell)
    half = 8
    touched = np.zeros((2 * half + 1, 2 * half + 1), bool)
    touched[half, half] = True
    within = cell * np.linspace(-0.5, 0.5, 9)
    for x in within:
        for y in within:
            for i in range(-half, half + 1):
                for j in range(-half, half + 1):
                    dx, dy = (max(abs(k * cell - at) - cell / 2, 0.0) for k, at in ((i, x), (j, y)))
                    touched[i + half, j + half] |= np.hypot(dx, dy) < radius - 1e-9
    own = slice(half - disc.half, half + disc.half + 1)
    np.testing.assert_array_equal(disc.inside, touched[own, own])
    assert touched.sum() == disc.inside.sum()


def test_the_cells_around_each_cell_are_those_of_the_disc():
    disc = FootDisc(0.0265, 0.02)
    assert disc.half == 2 and disc.inside.sum() == 21  # 5x5 without its corners
    values = np.random.default_rng(0).random((8, 7))
    around = disc.cells(values)
    assert around.shape == (4, 3, 21)
    np.testing.assert_array_equal(np.sort(around[1, 2]), np.sort(values[1:6, 2:7][disc.inside]))
