"""Fig. 11 shows the foothold that the map has moved out of a hole, where it was and where it went."""

from dataclasses import replace
from types import SimpleNamespace

import numpy as np
import pytest

from surefoot.bus.messages import (
    ElevationGrid,
    FootholdRegions,
    FootholdRequest,
    MotionReference,
    SimTruth,
    Unsafe,
)
from surefoot.config.deployment import Deployment
from surefoot.tools.reproduce.missing_planks import best_view, draw_maps, region_corners
from surefoot.tools.reproduce.recording.map_views import KEPT, MapViews, hole_cells
from surefoot.tools.reproduce.rocks import SHOTS, along_the_way

CELL_M = 0.02
SQUARE_A = np.array([[1.0, 0.0, 0.0], [-1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, -1.0, 0.0]])


def answer(number, unsafe_cells, moved_m, active=True):
    """A request and its answer for the front right leg: the first cells are in the hole."""
    target = np.tile([0.42, -0.14, 0.03], (4, 1))
    unsafe = np.zeros((4, 15, 15), int)
    unsafe[1].ravel()[:unsafe_cells] = Unsafe.EDGE
    unsafe[1].ravel()[unsafe_cells:] = Unsafe.UNKNOWN | Unsafe.EDGE  # guessed, not seen
    regions = FootholdRegions(
        id=number,
        foothold_WF=target + [moved_m, 0.0, 0.0],
        safe=np.ones(4, bool),
        region_a=np.tile(SQUARE_A, (4, 1, 1)),
        region_b=np.tile([-0.40, 0.60, 0.25, 0.0], (4, 1)),
        region_active=np.array([False, active, False, False]),
        cell_m=CELL_M,
        heightmap_p_W=np.tile([0.28, -0.28], (4, 1)),
        heightmap_m=np.zeros((4, 15, 15), np.float32),
        heightmap_unsafe=unsafe,
    )
    return FootholdRequest(id=number, target_WF=target), regions


@pytest.fixture
def views():
    """A recorder that has heard of the robot and of a map with a hole in it."""
    views = MapViews(Deployment())
    height = np.zeros((90, 80), np.float32)
    height[60:70, 30:40] = -0.2
    height[:5] = np.nan
    views("", SimTruth(t=7.0, p_WF=np.zeros((4, 3)), q=np.zeros(12), terrain_q=np.zeros(3)))
    views("", ElevationGrid(cell_m=CELL_M, p_W=np.array([-0.9, -0.8]), height_m=height))
    views("", MotionReference(leg=1))
    return views


def hear(views, *answers):
    for request, regions in answers:
        views("", request)
        views("", regions)


def test_the_view_with_most_of_the_hole_and_a_moved_foothold_comes_first(views):
    hear(views, answer(1, 40, 0.06), answer(2, 90, 0.06), answer(3, 200, 0.0), answer(4, 60, 0.04))
    kept = views.arrays()
    assert [hole_cells(unsafe) for unsafe in kept["heightmap_unsafe"][:3]] == [90, 60, 40]
    assert kept["qpos"].shape == (4, 22) and kept["grid_m"].shape == (4, 90, 80)
    assert [row[-1] for row in views.rows()] == [225] * 4
    hear(views, *(answer(number, 100 + number, 0.06) for number in range(5, 5 + KEPT)))
    assert len(views.arrays()["t"]) == KEPT and len(views.rows()) == 4 + KEPT


def test_an_answer_without_a_map_or_to_another_question_is_no_view(views):
    request, regions = answer(1, 40, 0.06)
    hear(views, (request, replace(regions, id=9)), answer(2, 40, 0.06, active=False))
    assert views.rows() == [] and views.arrays() == {}


def test_the_figure_is_drawn_from_the_best_view_of_all_runs(views, tmp_path):
    hear(views, answer(1, 40, 0.0))
    before = views.arrays()
    still = SimpleNamespace(spec=SimpleNamespace(seed=0), arrays=lambda name: before)
    assert best_view([still]) is None
    hear(views, answer(2, 40, 0.06))
    moved = SimpleNamespace(spec=SimpleNamespace(seed=3), arrays=lambda name: views.arrays())
    run, view = best_view([still, moved])
    assert run is moved and view["foothold_W"][0] == pytest.approx(0.48)
    pictures = draw_maps(run, view, tmp_path)
    assert "Seed 3" in pictures.caption and "FR" in pictures.caption
    assert pictures.files[0].read_text().startswith("<?xml")


def test_the_corners_of_a_region_are_where_its_sides_meet():
    b = np.array([-0.40, 0.60, 0.25, 0.0])
    corners = region_corners(SQUARE_A, b, 0.0)
    np.testing.assert_allclose(corners, [[0.4, -0.25], [0.6, -0.25], [0.6, 0.0], [0.4, 0.0]])
    # A side that leans takes the height into account; one that cuts nothing adds no corner.
    leaning = SQUARE_A.copy()
    leaning[1, 2] = -1.0
    np.testing.assert_allclose(region_corners(leaning, b, 0.1)[1], [0.5, -0.25])
    more = np.vstack([SQUARE_A, [-1.0, -1.0, 0.0]]), np.append(b, 5.0)
    assert len(region_corners(*more, 0.0)) == 4
    assert len(region_corners(SQUARE_A, np.array([-0.7, 0.6, 0.25, 0.0]), 0.0)) == 0  # no such place


def test_snapshots_are_spread_over_the_way():
    x = np.array([0.0, 0.01, 0.02, 0.31, 0.35, 0.62, 0.9])
    rows = along_the_way(x)
    assert rows == [0, 3, 5, 6] and len(rows) == SHOTS
    assert along_the_way(np.array([0.2, 0.2])) == [0]  # it has not moved: one picture
