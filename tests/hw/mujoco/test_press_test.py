"""The press test puts its sphere on whatever is there, presses it, and leaves no trace."""

import mujoco
import numpy as np
import pytest

from surefoot.config.deployment import Deployment
from surefoot.config.terrain import Edge, Planks, Slope, Terrain
from surefoot.hw.mujoco.press_test import COLLAPSE_M, PressTest

RADIUS = Deployment().load_robot().foot.radius
FRONT_X = Deployment().load_robot().legs["FL"].hip_p_B[0] + RADIUS
BOARD_Y = 0.5 * (Planks().gap_m + Planks().board_width_m)


def pressed(kind, **sections):
    return PressTest(Deployment(terrain=Terrain(kind=kind, **sections)))


def clearance(press, x, y, z):
    """Distance from the sphere, put at (x, y, z), to the terrain [m]."""
    model, data = press._model, press._data
    mujoco.mj_resetData(model, data)
    data.qpos[-3:] = [x, y, z]
    mujoco.mj_forward(model, data)
    sphere = model.geom("press").id
    others = [geom for geom in range(model.ngeom) if geom != sphere]
    return min(mujoco.mj_geomDistance(model, data, sphere, geom, 1.0, np.zeros(6)) for geom in others)


@pytest.fixture(scope="module")
def on_rocks():
    return pressed("rocks")


def test_the_sphere_begins_where_it_first_touches(on_rocks):
    # Neither inside a stone nor in the air: else the first displacement would be its own.
    rng = np.random.default_rng(4)
    heights = []
    for x, y in zip(rng.uniform(0.4, 1.1, 40), rng.uniform(-0.4, 0.4, 40), strict=True):
        mujoco.mj_resetData(on_rocks._model, on_rocks._data)
        z = on_rocks._lowered(x, y)
        heights.append(z - RADIUS)
        assert -1e-4 < clearance(on_rocks, x, y, z) < 2.5e-3
    assert max(heights) > 0.05 and min(heights) < 0.01


def test_it_lies_on_an_incline_by_its_side():
    angle = np.radians(8.0)
    press = pressed("slope", slope=Slope(angle_min_deg=8.0, angle_max_deg=8.0))
    x = FRONT_X + Planks().start_offset_m + 0.5
    height = (x - FRONT_X - Planks().start_offset_m) * np.tan(angle)
    assert press._lowered(x, BOARD_Y) == pytest.approx(height + RADIUS / np.cos(angle), abs=2e-4)


def test_it_does_not_fall_into_a_gap_and_does_into_a_hole():
    press = pressed("planks", planks=Planks(missing=((1, 2),)))
    row = FRONT_X + Planks().start_offset_m + Planks().pitch_m
    assert press._lowered(row + 0.15, 0.0) == pytest.approx(RADIUS, abs=5e-4), "between two boards"
    hole = press._lowered(row + 0.15, BOARD_Y)
    assert hole == pytest.approx(RADIUS - Planks().frame_height_m, abs=1e-6)
    assert not press.press(row + 0.15, BOARD_Y, 150.0).collapsible, "the ground beneath bears"


def test_where_nothing_is_it_says_so():
    with pytest.raises(ValueError, match=r"no ground under x = 50 m, y = 0 m"):
        pressed("flat").press(50.0, 0.0, 40.0)


def test_an_edge_holds_a_foot_on_either_side_of_it():
    edge = Edge(distance_spread_m=0.0)
    press = pressed("edge", edge=edge)
    for beyond in (-0.03, -0.005, 0.04):
        assert not press.press(FRONT_X + edge.distance_m + beyond, 0.1, 110.0).collapsible


def test_a_press_leaves_no_trace(on_rocks):
    before = [on_rocks.press(x, 0.1, 120.0).displacement_m for x in (0.6, 0.8)]
    for x in np.linspace(0.4, 1.1, 6):
        on_rocks.press(x, 0.1, 200.0)
    assert [on_rocks.press(x, 0.1, 120.0).displacement_m for x in (0.6, 0.8)] == before


def test_the_map_holds_the_label_of_every_point():
    press = pressed("planks")
    start_x = FRONT_X + Planks().start_offset_m
    xs, ys = start_x + np.array([-0.05, 0.02, 0.09, 0.2]), np.array([-BOARD_Y, BOARD_Y, 2.0 * BOARD_Y])
    sunk = press.label_map(xs, ys, 60.0)
    assert sunk.shape == (4, 3)
    for i, x in enumerate(xs):
        for j, y in enumerate(ys):
            assert sunk[i, j] == press.press(x, y, 60.0).displacement_m
    assert (sunk[:2] < 2e-3).all() and (sunk[3] > COLLAPSE_M).all()
    assert (press.label_map(xs, ys, 120.0)[2] > sunk[2]).all(), "a larger force sinks further"
