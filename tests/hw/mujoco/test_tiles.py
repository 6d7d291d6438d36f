"""A tile bears up to the load it was drawn with, falls beyond it and comes up again; of a trap none bears."""

import mujoco
import numpy as np
import pytest

from surefoot.config.deployment import Deployment
from surefoot.config.hw import Hw
from surefoot.config.terrain import Terrain, Tiles, Trap
from surefoot.hw.mujoco.press_test import COLLAPSE_M, PressTest
from surefoot.hw.mujoco.scene import build_scene
from surefoot.hw.mujoco.terrain.tiles import support_polynomial

TILES, TRAP = Tiles(), Trap()
GRAVITY = 9.81


def deployment(kind="tiles", seed=0, **settings):
    section = {"tiles": Tiles, "trap": Trap}[kind](**settings)
    return Deployment(terrain=Terrain(kind=kind, **{kind: section}), hw=Hw(seed=seed))


def support(model, name, sunk):
    """Force of a tile's spring at a sinking, as the simulation computes it [N]."""
    data = mujoco.MjData(model)
    joint = model.joint(name)
    data.qpos[joint.qposadr[0]] = -sunk
    mujoco.mj_forward(model, data)
    return data.qfrc_spring[joint.dofadr[0]]


def loads(model):
    """Load of every tile [N], from its spring in the compiled scene."""
    names = [model.joint(i).name for i in range(model.njnt) if "tile" in model.joint(i).name]
    return {name: support(model, name, 0.0) - TILES.mass * GRAVITY for name in names}


def middle(model, name):
    data = mujoco.MjData(model)
    mujoco.mj_kinematics(model, data)
    return data.body(name).xpos[:2]


@pytest.mark.parametrize("load_n", [40.0, 100.0, 160.0])
def test_the_label_flips_at_the_load(load_n):
    all_alike = deployment(rows=3, columns=3, load_min_n=load_n, load_max_n=load_n)
    press = PressTest(all_alike)
    x, y = middle(build_scene(all_alike, None, 0.6)[0], "tile_1_1")
    assert press.press(x, y, load_n - 10.0).displacement_m < 1.5e-3
    assert press.press(x, y, load_n - 2.0).displacement_m < 0.3 * COLLAPSE_M
    assert press.press(x, y, load_n + 2.0).collapsible
    assert press.press(x, y, load_n + 20.0).displacement_m > 0.06


def test_every_tile_flips_at_the_load_it_was_drawn_with():
    drawn = deployment(rows=4, columns=4, seed=3)
    model, press = build_scene(drawn, None, 0.6)[0], PressTest(drawn)
    for name, load_n in loads(model).items():
        x, y = middle(model, name)
        assert TILES.load_min_n <= load_n <= TILES.load_max_n
        assert not press.press(x, y, load_n - 2.0).collapsible
        assert press.press(x, y, load_n + 2.0).collapsible


@pytest.mark.parametrize("beside_m", [0.0, 0.005, 0.010])
def test_where_two_tiles_meet_they_bear_the_sum_of_their_loads(beside_m):
    all_alike = deployment(rows=3, columns=3, load_min_n=50.0, load_max_n=50.0)
    press, model = PressTest(all_alike), build_scene(all_alike, None, 0.6)[0]
    joint = 0.5 * (middle(model, "tile_1_1") + middle(model, "tile_2_1"))
    assert not press.press(joint[0] + beside_m, joint[1], 95.0).collapsible
    assert press.press(joint[0] + beside_m, joint[1], 105.0).collapsible


def test_loads_fill_their_range_and_come_from_the_seed():
    drawn = np.array(list(loads(build_scene(deployment(), None, 0.6)[0]).values()))
    assert len(drawn) == TILES.rows * TILES.columns
    assert drawn.min() < 50.0 and drawn.max() > 150.0
    again, other = (build_scene(deployment(seed=seed), None, 0.6)[0] for seed in (0, 1))
    np.testing.assert_array_equal(list(loads(again).values()), drawn)
    assert not np.allclose(list(loads(other).values()), drawn)


def test_the_support_weakens_all_the_way_and_still_lifts_the_tile():
    model = build_scene(deployment(rows=2, columns=2, load_min_n=90.0, load_max_n=90.0), None, 0.6)[0]
    weight = TILES.mass * GRAVITY
    for share in (0.0, 0.25, 0.5, 0.75, 1.0):
        expected = weight + TILES.return_n + (90.0 - TILES.return_n) * (1.0 - share) ** 3
        assert support(model, "tile_0_0", share * TILES.travel_m) == pytest.approx(expected, abs=1e-6)
    reference, _ = support_polynomial(90.0, weight, TILES.return_n, TILES.travel_m)
    assert reference < -TILES.travel_m


def test_a_tile_falls_all_the_way_comes_up_again_and_then_rests():
    model = build_scene(deployment(rows=2, columns=2, load_min_n=100.0, load_max_n=100.0), None, 0.6)[0]
    data = mujoco.MjData(model)
    assert data.ntree_awake == 0
    data.qfrc_applied[0] = -103.0
    for _ in range(500):
        mujoco.mj_step(model, data)
    assert data.qpos[0] < -0.1 and (data.qpos[1:] == 0.0).all()
    assert data.ntree_awake == 1, "its neighbours sleep on"
    data.qfrc_applied[0] = 0.0
    fastest = 0.0
    for _ in range(1500):
        mujoco.mj_step(model, data)
        fastest = max(fastest, data.qvel[0])
    assert fastest < 2.0, "it does not hit the foot that it held"
    np.testing.assert_allclose(data.qpos, 0.0, atol=1e-4)
    assert data.ntree_awake == 0


def test_what_begins_asleep_begins_in_balance():
    model = build_scene(deployment(), None, 0.6)[0]
    model.opt.enableflags = 0
    data = mujoco.MjData(model)
    for _ in range(100):
        mujoco.mj_step(model, data)
        assert np.abs(data.qpos).max() < 5e-5


def test_gaps_are_narrower_than_a_foot_sees():
    press = PressTest(deployment())
    field = build_scene(deployment(), None, 0.6)[1]
    between = field.start_x + TILES.tile_m + 0.5 * TILES.gap_m
    assert TILES.gap_m <= 0.003
    assert press.press(between, 0.5 * TILES.tile_m, 30.0).displacement_m < 1.5e-3


def test_of_a_trap_nothing_bears_a_foot():
    trapped = deployment("trap")
    press, field = PressTest(trapped), build_scene(trapped, None, 0.6)[1]
    assert field.end_x - field.start_x >= 0.8
    # A foot's radius past the run-up, and on to where the run-out begins to help; on seams and corners too.
    pitch = TRAP.tile_m + TRAP.gap_m
    xs = field.start_x + np.array([0.03, *np.arange(0.1, 0.95, 0.1), *pitch * np.arange(1, 5)])
    ys = np.array([-0.7, -0.3, -0.13, 0.0, 0.1, pitch, 0.5])
    sunk = press.label_map(xs, ys, 40.0)
    assert (sunk > COLLAPSE_M).all()
    assert np.median(sunk) > 0.05
    assert not press.press(field.start_x - 0.03, 0.13, 150.0).collapsible, "the run-up bears"
