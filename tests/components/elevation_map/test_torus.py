"""The window keeps what it should wherever it goes, and forgets the rest."""

import numpy as np
import pytest

from surefoot.components.elevation_map.torus import Torus


def test_against_a_dictionary_of_the_whole_world():
    rng = np.random.default_rng(4)
    torus, world, p_W = Torus(0.1, 0.7, 0.5), {}, np.zeros(2)
    layer = torus.add("layer", np.nan)
    torus.move_to(p_W)
    for step in range(400):
        # Mostly a step, at times a leap of up to two windows.
        p_W = p_W + rng.normal(scale=0.05 if step % 13 else 0.6, size=2)
        torus.move_to(p_W)
        window = torus.first + np.stack(np.meshgrid(np.arange(7), np.arange(5), indexing="ij"), axis=-1)
        kept = {tuple(cell) for cell in window.reshape(-1, 2).tolist()}
        world = {cell: value for cell, value in world.items() if cell in kept}
        cells = torus.cells(p_W + rng.uniform(-0.5, 0.5, size=(3, 2)))
        inside, at = torus.find(cells)
        assert inside.tolist() == [tuple(cell) in kept for cell in cells.tolist()]
        for cell, place in zip(cells[inside].tolist(), at, strict=True):
            layer.reshape(-1)[place] = world[tuple(cell)] = float(step)
        block = torus.block(torus.first - 2, (11, 9))["layer"]
        for (i, j), value in np.ndenumerate(block):
            cell = (int(torus.first[0]) - 2 + i, int(torus.first[1]) - 2 + j)
            np.testing.assert_equal(value, world.get(cell, np.nan))
    assert len(world) > 5


def test_a_place_is_in_the_middle_after_moving_there():
    torus = Torus(0.02, 2.4, 1.6)
    torus.move_to(np.array([-3.217, 8.013]))
    middle = torus.places(torus.first + np.array(torus.shape) // 2)
    assert np.abs(middle - [-3.217, 8.013]).max() <= 0.5 * torus.cell_m + 1e-12


def test_a_cell_is_found_again_from_where_it_is_stored():
    torus = Torus(0.1, 0.7, 0.5)
    torus.move_to(np.array([-1.23, 4.56]))
    cells = torus.stored(np.arange(35))
    inside, at = torus.find(cells)
    assert inside.all()
    np.testing.assert_array_equal(at, np.arange(35))


@pytest.mark.parametrize("place", [(0.0, 0.0), (-0.001, 0.019), (1e3, -1e3)])
def test_a_cells_centre_lies_in_it(place):
    torus = Torus(0.02, 2.4, 1.6)
    cell = torus.cells(np.array(place))
    np.testing.assert_array_equal(torus.cells(torus.places(cell)), cell)
    assert np.abs(torus.places(cell) - place).max() <= 0.01 + 1e-9


def test_clearing_forgets_all_layers():
    torus = Torus(0.1, 0.7, 0.5)
    for name, blank in (("a", np.nan), ("b", 0)):
        torus.add(name, blank)[:] = 3.0
    torus.clear()
    assert np.isnan(torus.layers["a"]).all() and (torus.layers["b"] == 0.0).all()
