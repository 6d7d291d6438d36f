"""Sections of a lane stand one behind the other, platforms between, at the height where the last one ended."""

import mujoco
import numpy as np
import pytest

from surefoot.config.deployment import Deployment
from surefoot.config.hw import Hw
from surefoot.config.terrain import Edge, Lane, Planks, Rocks, Slope, Terrain, Tiles
from surefoot.hw.mujoco.press_test import PressTest
from surefoot.hw.mujoco.scene import build_scene

ROW = ("planks", "slope", "tiles", "edge", "planks", "tiles")
PLATFORM_M = Lane().platform_m


def deployment(sections=ROW, seed=0):
    return Deployment(terrain=Terrain(kind="lane", lane=Lane(sections=sections)), hw=Hw(seed=seed))


class Scene:
    def __init__(self, deployment):
        self.model, self.field = build_scene(deployment, None, 0.6)
        self.data = mujoco.MjData(self.model)
        mujoco.mj_forward(self.model, self.data)

    def extent(self, prefix):
        """Least and largest x of the boxes whose names begin so."""
        model, data = self.model, self.data
        ids = [i for i in range(model.ngeom) if model.geom(i).name.startswith(prefix)]
        assert ids, prefix
        half = np.array([np.abs(data.geom_xmat[i].reshape(3, 3)[0]) @ model.geom_size[i] for i in ids])
        x = data.geom_xpos[ids, 0]
        return (x - half).min(), (x + half).max()


def test_sections_come_in_order_and_do_not_overlap():
    scene = Scene(deployment())
    end = scene.extent("run_up")[1]
    assert end == pytest.approx(scene.field.start_x)
    for number in range(len(ROW)):
        # A board on an incline leans back by its thickness.
        if number:
            platform = scene.extent(f"{number}_platform")
            assert platform[0] == pytest.approx(end, abs=0.02)
            assert platform[1] - platform[0] == pytest.approx(PLATFORM_M)
            end = platform[1]
        own = [kind for kind in ("board", "beam", "tile", "high", "low") if has(scene.model, f"{number}_{kind}")]
        extents = np.array([scene.extent(f"{number}_{kind}") for kind in own])
        assert extents[:, 0].min() == pytest.approx(end, abs=0.015)
        assert extents[:, 1].max() > end + 0.2
        end = extents[:, 1].max()
    assert scene.field.end_x == pytest.approx(scene.extent("run_out")[0])


def has(model, prefix):
    return any(model.geom(i).name.startswith(prefix) for i in range(model.ngeom))


def test_the_surface_is_one_without_holes_or_steps_but_the_edge():
    press = PressTest(deployment())
    field = Scene(deployment()).field
    xs = np.arange(field.start_x - 0.3, field.end_x + 0.5, 0.0317)
    off = np.array([press.surface(x, 0.11) - field.level(x) for x in xs])
    assert (np.abs(off) < 1e-6).mean() > 0.95, "all but the gaps between boards and between tiles"
    assert off.max() < 1e-6
    steps = [b[1] - a[1] for a, b in zip(field.profile, field.profile[1:], strict=False) if a[0] == b[0]]
    (drop,) = [-step for step in steps if abs(step) > 1e-9]
    assert Edge().drop_min_m <= drop <= Edge().drop_max_m


def test_each_section_is_what_it_is_alone():
    press = PressTest(deployment())
    field = Scene(deployment()).field
    second = field.start_x + Planks().rows * Planks().pitch_m + PLATFORM_M
    assert press.press(field.start_x + 0.2, 0.1, 60.0).collapsible
    assert not press.press(field.start_x + 0.02, 0.1, 150.0).collapsible
    assert press.press(second + 0.2, 0.1, 60.0).collapsible
    assert not press.press(second - 0.3, 0.1, 150.0).collapsible


def test_two_of_a_kind_are_drawn_apart():
    scene = Scene(deployment(("tiles", "tiles")))
    half = Tiles().rows * Tiles().columns
    assert scene.model.njnt == 2 * half
    springs = scene.model.qpos_spring
    assert not np.allclose(springs[:half], springs[half:])


def test_stones_in_a_lane_lie_on_their_bed():
    rocks = Rocks()
    scene = Scene(deployment(("slope", "rocks", "edge")))
    bed = scene.extent("1_bed")
    height = scene.field.level(bed[0] + 0.1)
    assert bed[1] - bed[0] == pytest.approx(rocks.length_m) and height > 0.08
    stones = [i for i in range(scene.model.nbody) if scene.model.body(i).name.startswith("1_rock")]
    assert len(stones) == rocks.count
    assert scene.data.xpos[stones, 2].min() > height
    before = scene.data.xpos[stones].copy()
    scene.model.opt.enableflags = 0
    for _ in range(200):
        mujoco.mj_step(scene.model, scene.data)
    moved = np.linalg.norm(scene.data.xpos[stones] - before, axis=1)
    # Stones that lie over the bed's edges fall off it.
    on_it = np.abs(before[:, 0] - np.mean(bed)) < 0.5 * rocks.length_m - 0.1
    assert np.percentile(moved[on_it], 90) < 2e-3


def test_a_lane_that_goes_down_has_room_beneath():
    down = Deployment(
        terrain=Terrain(
            kind="lane",
            lane=Lane(sections=("slope", "planks")),
            slope=Slope(angle_min_deg=-8.0, angle_max_deg=-8.0),
        )
    )
    scene = Scene(down)
    low = scene.field.level(scene.field.end_x)
    assert low < -0.1
    assert low - scene.data.geom("ground").xpos[2] == pytest.approx(Planks().frame_height_m)
    assert scene.extent("1_beam")[1] < scene.field.end_x
