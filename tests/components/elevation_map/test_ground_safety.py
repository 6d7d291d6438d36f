"""Every reason that the ground itself gives, on ground whose answer is known cell by cell.

The target of the front left leg is the middle (7, 7) of its heightmap; index i along x is at 0.2 + 0.02 (i - 7).
"""

import numpy as np
import pytest
from made_up_ground import RADIUS, Ground, flagged, on_slope, reasons, rows, standing_at

from surefoot.bus.messages import Unsafe

AT = standing_at(0.2, 0.2)
STEP_X = 0.25  # the border between cells 9 and 10


def block(i, j, half=2):
    """(15, 15) true in the square around a cell that a foot's disc reaches from its cells."""
    cells = np.zeros((15, 15), bool)
    cells[max(i - half, 0) : i + half + 1, max(j - half, 0) : j + half + 1] = True
    return cells


def test_flat_ground_is_safe_for_every_leg():
    answer = Ground().ask()
    assert not answer.heightmap_unsafe.any()
    assert answer.safe.all() and answer.region_active.all()
    assert answer.reasons == ("the target is safe",) * 4


@pytest.mark.parametrize("sign", [1.0, -1.0])
def test_a_step_is_an_edge_exactly_where_the_disc_meets_it(sign):
    answer = Ground(lambda x, y: np.where(x > STEP_X, 0.05 * sign, 0.0)).ask(**AT)
    assert rows(answer, Unsafe.EDGE) == [8, 9, 10, 11]
    across = Ground(lambda x, y: np.where(y > STEP_X, 0.05 * sign, 0.0)).ask(**AT)
    np.testing.assert_array_equal(flagged(across, Unsafe.EDGE), flagged(answer, Unsafe.EDGE).T)


def test_a_step_that_the_foot_bears_is_none():
    ground = Ground(lambda x, y: np.where(x > STEP_X, 0.028, 0.0))
    assert not flagged(ground.ask(**AT), Unsafe.EDGE).any()
    ground = Ground(lambda x, y: np.where(x > STEP_X, 0.032, 0.0))
    assert rows(ground.ask(**AT), Unsafe.EDGE) == [8, 9, 10, 11]


def test_an_edge_smeared_over_a_cell_is_still_one():
    """Where a pixel sees both sides the map has a height between: neither half of the step is 3 cm."""
    ground = Ground(lambda x, y: np.where(x > STEP_X, np.where(x > STEP_X + 0.02, 0.05, 0.025), 0.0))
    assert rows(ground.ask(**AT), Unsafe.EDGE) == [9, 10, 11]


def test_a_pit_is_an_edge_all_around():
    ground = Ground()
    ground.height[ground.cell(0.26, 0.2)] = -0.1
    np.testing.assert_array_equal(flagged(ground.ask(**AT), Unsafe.EDGE), block(10, 7))


@pytest.mark.parametrize("degrees", [25.0, -25.0, 29.5, -29.5])
def test_a_ramp_of_less_than_30_degrees_is_safe(degrees):
    slope = np.deg2rad(degrees)
    asked = on_slope(slope, 0.2, 0.2)
    answer = Ground(lambda x, y: np.tan(slope) * x).ask(**asked)
    assert not answer.heightmap_unsafe.any()
    # The sphere lies on the slope, it does not stand on the height below its centre.
    np.testing.assert_allclose(answer.foothold_WF, asked["targets"], atol=1e-9)


@pytest.mark.parametrize("degrees", [31.0, -35.0])
def test_a_steeper_one_is_steep_and_nothing_else(degrees):
    slope = np.deg2rad(degrees)
    answer = Ground(lambda x, y: np.tan(slope) * x).ask(**on_slope(slope, 0.2, 0.2))
    assert (answer.heightmap_unsafe == Unsafe.STEEP).all()
    assert not answer.safe.any() and answer.reasons[0] == "no safe cell of 225: 225 steep"


def test_a_diagonal_ramp_is_judged_by_its_slope():
    rise = np.tan(np.deg2rad(27.0)) / np.sqrt(2.0)
    assert not flagged(Ground(lambda x, y: rise * (x + y)).ask(**AT), Unsafe.STEEP | Unsafe.EDGE).any()
    rise = np.tan(np.deg2rad(33.0)) / np.sqrt(2.0)
    assert flagged(Ground(lambda x, y: rise * (x + y)).ask(**AT), Unsafe.STEEP).all()


def checker(amplitude):
    return lambda x, y: amplitude * (-1.0) ** np.round((x + y) / 0.02)


def test_a_checker_board_is_rough_from_2_cm_off_its_plane():
    assert flagged(Ground(checker(0.025)).ask(**AT), Unsafe.ROUGH).all()
    assert not Ground(checker(0.012)).ask(**AT).heightmap_unsafe.any()


def test_a_hollow_without_an_edge_is_rough_where_the_foot_bridges_it():
    ground = Ground(lambda x, y: 0.7 * (np.abs(x - 0.2) + np.abs(y - 0.2)))
    answer = ground.ask(**AT)
    assert not flagged(answer, Unsafe.EDGE).any()
    assert flagged(answer, Unsafe.ROUGH)[7, 7]
    assert not flagged(answer, Unsafe.ROUGH)[:4, :4].any()  # there it is a plane


def test_what_lacks_under_the_foot_is_unknown():
    ground = Ground(lambda x, y: np.where(np.abs(x - 0.26) < 0.005, np.nan, 0.0))
    answer = ground.ask(**AT)
    assert rows(answer, Unsafe.UNKNOWN) == [8, 9, 10, 11, 12]
    assert reasons(answer) == Unsafe.UNKNOWN


def test_a_single_dropout_is_unknown_alone():
    ground = Ground()
    ground.height[ground.cell(0.26, 0.2)] = np.nan
    answer = ground.ask(**AT)
    assert np.argwhere(answer.heightmap_unsafe[0]).tolist() == [[10, 7]]
    assert reasons(answer) == Unsafe.UNKNOWN
    assert np.isnan(answer.heightmap_m[0, 10, 7]) and np.isnan(answer.heightmap_m[0]).sum() == 1


@pytest.mark.parametrize(("field", "value"), [("std", 0.021), ("std", np.nan), ("age", 601.0), ("age", np.nan)])
def test_what_is_not_known_well_or_was_seen_long_ago_is_uncertain(field, value):
    ground = Ground()
    getattr(ground, field)[ground.x > STEP_X] = value
    answer = ground.ask(**AT)
    assert rows(answer, Unsafe.UNCERTAIN) == [8, 9, 10, 11, 12, 13, 14]
    assert reasons(answer) == Unsafe.UNCERTAIN


def test_what_is_known_just_well_enough_is_certain():
    ground = Ground()
    ground.std[:], ground.age[:] = 0.02, 600.0
    assert not ground.ask(**AT).heightmap_unsafe.any()


def test_where_the_ground_gave_way_no_foot_may_touch_it():
    ground = Ground()
    ground.collapsed[ground.cell(0.26, 0.2)] = 35.0
    answer = ground.ask(**AT)
    np.testing.assert_array_equal(answer.heightmap_unsafe[0], Unsafe.COLLAPSED * block(10, 7))


def test_every_reason_is_kept():
    ground = Ground(lambda x, y: np.where(x > STEP_X, 0.12, 0.0))
    ground.std[:] = 0.05
    ground.collapsed[:] = 20.0
    cell = Unsafe(int(ground.ask(**AT).heightmap_unsafe[0, 9, 7]))
    assert cell & ~Unsafe.LEG == (Unsafe.EDGE | Unsafe.STEEP | Unsafe.ROUGH | Unsafe.UNCERTAIN | Unsafe.COLLAPSED)


def test_the_foot_stands_on_the_map_not_on_the_targets_height():
    answer = Ground(lambda x, y: np.full(x.shape, 0.03)).ask(**AT)
    np.testing.assert_allclose(answer.foothold_WF[:, 2], 0.03 + RADIUS, atol=1e-12)
    np.testing.assert_array_equal(answer.foothold_WF[:, :2], AT["targets"][:, :2])
