"""The map is the press test's, point by point, and stands in the picture where it stands in the world."""

import csv
import sys

import numpy as np
import pytest

from surefoot.config.deployment import Deployment
from surefoot.config.terrain import Planks, Terrain
from surefoot.config.typed_toml import ConfigError
from surefoot.hw.mujoco.press_test import PressTest
from surefoot.tools.cli import main
from surefoot.tools.evaluation.label_map import LabelMap, draw, press_terrain

ONE_ROW = Deployment(terrain=Terrain(kind="planks", planks=Planks(rows=1, columns=2)))
FORCE_N = 110.0


@pytest.fixture(scope="module")
def label():
    return press_terrain(ONE_ROW, FORCE_N, 0.05, say=lambda line: None)


def test_every_point_is_the_press_tests(label):
    test = PressTest(ONE_ROW)
    assert label.displacement_m.shape == (len(label.x_m), len(label.y_m))
    for i, j in ((0, 0), (3, 7), (5, 11), (len(label.x_m) - 1, 4)):
        pressed = test.press(float(label.x_m[i]), float(label.y_m[j]), FORCE_N)
        assert label.displacement_m[i, j] == pressed.displacement_m
        assert label.collapsible[i, j] == pressed.collapsible


def test_the_map_goes_from_the_run_up_over_the_terrain_to_the_run_out(label):
    assert not label.collapsible[0].any() and not label.collapsible[-1].any()
    assert label.collapsible.any()
    middle = np.abs(label.y_m) < 0.15  # on the boards, not beside them
    assert not label.collapsible[:, middle].all(axis=0).any()


def test_it_says_how_far_it_is():
    said = []
    press_terrain(ONE_ROW, FORCE_N, 0.2, say=said.append)
    assert said and said[-1].split()[0] == said[-1].split()[2]


def painted(path):
    """(rows, columns, 3) colours of a picture, the top row first."""
    from matplotlib.image import imread

    return imread(path)[:, :, :3]


def test_the_picture_is_not_mirrored_and_its_figures_lie_beside_it(tmp_path):
    """Only the quarter that lies ahead and to the left gives way: in the picture the top right one is dark."""
    x, y = np.linspace(0.0, 1.0, 21), np.linspace(-0.4, 0.4, 17)
    moved = np.where((x[:, None] > 0.5) & (y > 0.0), 0.10, 0.0)
    out = tmp_path / "new" / "map.png"
    draw(LabelMap(x, y, moved, FORCE_N), "a quarter", out)
    dark = painted(out).sum(axis=2) < 0.8  # the map's own darkest, not the black of the letters
    rows, columns = np.nonzero(dark)
    height, width = dark.shape
    assert len(rows) > 0.05 * dark.size
    assert np.median(rows) < 0.5 * height and np.median(columns) > 0.45 * width
    with out.with_suffix(".csv").open() as file:
        read = [{key: float(value) for key, value in row.items()} for row in csv.DictReader(file)]
    assert len(read) == moved.size
    for row in read:
        assert row["displacement_m"] == (0.10 if row["x_m"] > 0.5 and row["y_m"] > 0.0 else 0.0)


def test_where_there_is_no_ground_there_is_no_figure(tmp_path):
    moved = np.zeros((4, 4))
    moved[1, 2] = np.nan
    label = LabelMap(np.arange(4.0), np.arange(4.0), moved, FORCE_N)
    assert not label.collapsible.any()
    draw(label, "a hole", tmp_path / "map.png")
    assert (tmp_path / "map.csv").read_text().count("nan") == 1


def test_the_command_presses_what_it_is_told_to(tmp_path, capsys):
    scenario = tmp_path / "row.toml"
    scenario.write_text('[terrain]\nkind = "planks"\n[terrain.planks]\nrows = 1\ncolumns = 2\n')
    call = ["press", str(scenario), "--step", "0.1", "--seed", "3", "--out"]
    assert main([*call, str(tmp_path / "heavy.png"), "--force", "110"]) == 0
    assert "figures in" in capsys.readouterr().out
    stiff = ["--set", "terrain.planks.stiffness=1e5"]
    assert main([*call, str(tmp_path / "stiff.png"), "--force", "110", *stiff]) == 0
    heavy, stiff = ((tmp_path / f"{name}.csv").read_text() for name in ("heavy", "stiff"))
    assert heavy != stiff


def test_without_matplotlib_it_is_said_before_the_work(tmp_path, monkeypatch, capsys):
    monkeypatch.setitem(sys.modules, "matplotlib.figure", None)
    assert main(["press", "planks", "--out", str(tmp_path / "map.png")]) == 2
    said = capsys.readouterr()
    assert "pip install 'surefoot[report]'" in said.err and "pressed" not in said.out


@pytest.mark.parametrize("force_n", [1.0, 2001.0, float("nan")])
def test_a_force_that_cannot_be_pressed_is_named(force_n):
    with pytest.raises(ConfigError, match="--force"):
        press_terrain(ONE_ROW, force_n)
