"""What is drawn of a recorded instant, without a browser."""

import numpy as np
import pytest
import scenes

from surefoot.bus.messages import ElevationGrid, MotionReference, SimTruth, StateEstimate
from surefoot.config.deployment import load_deployment
from surefoot.tools.view.drawing import Arrows, Shapes
from surefoot.tools.view.heard import Heard
from surefoot.tools.view.layers import LAYERS
from surefoot.tools.view.map_tiles import draw_map
from surefoot.tools.view.palette import FORCE_M_PER_N, VERDICT_RGB, Verdict
from surefoot.tools.view.recording_source import RecordingSource
from surefoot.tools.view.scene import Scene
from surefoot.tools.view.terrain_shapes import TerrainShapes

PROBES_T, FALLS_T = 23.1, 23.18  # of the clip
PLANKS = scenes.CONFIG / "planks.toml"


@pytest.fixture(scope="module")
def collapse():
    source = RecordingSource(scenes.path("collapse"))
    return source, Scene(source.deployment)


def drawn(collapse, t, hidden=()):
    source, scene = collapse
    source.seek(t)
    return scene.draw(source.heard, hidden)


def test_a_probing_robot_is_drawn_with_its_forces_its_support_and_its_plans(collapse):
    drawing = drawn(collapse, PROBES_T)
    assert {name.partition("/")[0] for name in drawing} == set(LAYERS) - {"map", "loads", "envelope", "candidates"}
    heard = collapse[0].heard
    arrows = drawing["forces/measured"]
    assert isinstance(arrows, Arrows)
    lengths = arrows.points_W[:, 1] - arrows.points_W[:, 0]
    pressing = np.linalg.norm(heard.estimate.force_W, axis=1) > 3.0
    assert lengths == pytest.approx(FORCE_M_PER_N * heard.estimate.force_W[pressing])


def test_the_place_that_gave_way_is_red_from_the_collapse_on(collapse):
    red = list(VERDICT_RGB[Verdict.COLLAPSED])
    assert red in drawn(collapse, FALLS_T)["footholds/discs"].rgb.tolist()
    assert red not in drawn(collapse, FALLS_T - 0.01)["footholds/discs"].rgb.tolist()


def test_a_hidden_layer_is_not_drawn(collapse):
    assert not any(name.startswith("forces/") for name in drawn(collapse, PROBES_T, {"forces"}))


def test_the_margin_is_that_of_the_three_feet_that_carry(collapse):
    source, scene = collapse
    source.seek(PROBES_T)
    assert 0.0 < scene.margin_m(source.heard) < 0.1


def test_nothing_heard_is_only_the_terrain():
    drawing = Scene(load_deployment(PLANKS)).draw(Heard())
    assert set(drawing) == {"terrain/boxes"}


def test_a_robot_that_has_no_footholds_yet_is_drawn_all_the_same(collapse):
    heard = Heard(estimate=StateEstimate(quat_WB=np.array([1.0, 0.0, 0.0, 0.0])), reference=MotionReference())
    drawing = collapse[1].draw(heard)
    assert "robot/feet" in drawing and "support/area" not in drawing


def test_boards_are_where_the_simulators_truth_has_them_and_are_made_anew_only_then():
    terrain = TerrainShapes(load_deployment(PLANKS))
    still = terrain.draw(None)
    boards = terrain.draw(SimTruth(terrain_q=np.zeros(0)))["terrain/boxes"]
    assert boards is still["terrain/boxes"]
    count = len(terrain._model.jnt_type)
    sunk = np.zeros(count)
    sunk[2] = 0.2
    moved = terrain.draw(SimTruth(terrain_q=sunk))["terrain/boxes"]
    assert isinstance(moved, Shapes) and (moved.p_W[:, 2] < still["terrain/boxes"].p_W[:, 2] - 0.001).sum() == 1
    assert terrain.draw(SimTruth(terrain_q=sunk + 1e-6))["terrain/boxes"] is moved


def test_a_real_robot_stands_on_no_simulated_ground():
    deployment = load_deployment(scenes.CONFIG / "aliengo.toml")
    assert Scene(deployment).draw(Heard()) == {}


@pytest.mark.parametrize("kind", ["flat", "rocks", "tiles", "foam", "slope", "edge", "trap"])
def test_every_terrain_can_be_drawn(kind):
    drawing = TerrainShapes(load_deployment(scenes.CONFIG / "flat.toml", [f"terrain.kind={kind}"])).draw(None)
    assert drawing and ("terrain/stones" in drawing) == (kind == "rocks")


def test_tested_cells_are_green_or_red_and_unknown_ones_are_not_there():
    height = np.zeros((3, 2), np.float32)
    height[2, 1] = np.nan
    held, collapsed = np.zeros_like(height), np.zeros_like(height)
    held[0, 0], collapsed[1, 1] = 120.0, 90.0
    grid = ElevationGrid(
        cell_m=0.02, p_W=np.array([1.0, 2.0]), height_m=height, std_m=height, age_s=height, held_n=held,
        collapsed_n=collapsed,
    )  # fmt: skip
    drawing = draw_map(grid)
    assert len(drawing["map/heights"].p_W) == 5
    loads = drawing["loads/cells"]
    assert loads.p_W[:, :2] == pytest.approx(np.array([[1.0, 2.0], [1.02, 2.02]]))
    assert loads.rgb[0, 1] > loads.rgb[0, 0] and loads.rgb[1].tolist() == list(VERDICT_RGB[Verdict.COLLAPSED])
