"""Distances to a drop are those of the ground that was built, and only of feet that could slip off it."""

import numpy as np
import pytest

from surefoot.config.deployment import Deployment
from surefoot.config.terrain import Lane, Terrain
from surefoot.hw.mujoco.press_test import PressTest
from surefoot.hw.mujoco.scene import build_scene
from surefoot.hw.mujoco.terrain import Field
from surefoot.tools.evaluation.drops import Drops

R = 0.0265
DOWN = Field(0.0, 2.0, ((0.0, 0.1), (1.0, 0.1), (1.0, 0.07), (2.0, 0.07)))
UP = Field(0.0, 2.0, ((0.0, 0.0), (1.0, 0.0), (1.0, 0.03), (2.0, 0.03)))
PIT = Field(0.0, 2.0, ((0.0, 0.0), (0.5, 0.0), (0.5, -0.04), (0.6, -0.04), (0.6, 0.0), (2.0, 0.0)))


@pytest.mark.parametrize(
    ("field", "x", "ground", "expected"),
    [
        (DOWN, 0.96, 0.1, 0.04),
        (DOWN, 1.01, 0.1, -0.01),  # its centre is past the edge, its pad still on it
        (DOWN, 1.01, 0.07, None),  # it stands below
        (DOWN, 0.7, 0.1, None),  # far away
        (UP, 1.02, 0.03, 0.02),  # a step up has its drop behind
        (UP, 0.98, 0.0, None),
        (PIT, 0.48, 0.0, 0.02),
        (PIT, 0.63, 0.0, 0.03),
        (PIT, 0.55, -0.04, None),
        (Field(0.0, 1.0), 0.5, 0.0, None),
    ],
)
def test_the_distance_is_to_the_nearest_drop_beside_the_ground_it_stands_on(field, x, ground, expected):
    distance = Drops(field, R).distance(np.array([x, 0.3, ground + R - 1e-3]))  # pressed in by a millimetre
    assert distance is None if expected is None else distance == pytest.approx(expected)


@pytest.mark.parametrize(
    "terrain", [Terrain(kind="edge"), Terrain(kind="lane", lane=Lane(sections=("edge", "edge")))]
)
def test_it_is_where_the_ground_really_drops(terrain):
    deployment = Deployment(terrain=terrain)
    _, field = build_scene(deployment, None, 0.6)
    drops, press = Drops(field, R), PressTest(deployment)
    xs = np.arange(field.start_x, field.end_x, 0.0005)
    heights = np.array([press.surface(x, 0.05) for x in xs])
    fall = int(np.argmin(np.diff(heights)))
    assert heights[fall] - heights[fall + 1] > 0.015
    foot = np.array([xs[fall] - 0.03, 0.05, heights[fall] + R])
    assert drops.distance(foot) == pytest.approx(0.03, abs=6e-4)


@pytest.mark.parametrize("kind", ["flat", "planks", "slope", "tiles", "rocks"])
def test_other_terrains_have_none(kind):
    _, field = build_scene(Deployment(terrain=Terrain(kind=kind)), None, 0.6)
    for x in np.arange(field.start_x - 0.3, field.end_x + 0.3, 0.05).tolist():
        assert Drops(field, R).distance(np.array([x, 0.0, field.level(x) + R])) is None
