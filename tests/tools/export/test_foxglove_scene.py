"""The scene for a 3D panel shows the robot where it was, and what pressed on its feet."""

import json

import numpy as np
import pytest
import scenes
from mcap.reader import make_reader

from surefoot.components.robot_model.rotation import matrix_of
from surefoot.tools.cli import main
from surefoot.tools.export.foxglove_scene import RATE_HZ
from surefoot.tools.tables.recording_tables import load

CLIP = scenes.path("collapse")


@pytest.fixture(scope="module")
def updates(tmp_path_factory):
    """(time [s], entities by name) of every update."""
    out = tmp_path_factory.mktemp("scene") / "a.mcap"
    assert main(["export", str(CLIP), "--to", "json-mcap", "--from", "23.0", "--out", str(out)]) == 0
    with out.open("rb") as file:
        found = list(make_reader(file).iter_messages(["scene"]))
    assert {schema.name for schema, _, _ in found} == {"foxglove.SceneUpdate"}
    told = [(message.log_time / 1e9, json.loads(message.data)) for _, _, message in found]
    return [(t, {entity["id"]: entity for entity in each["entities"]}) for t, each in told]


def xyz(vector):
    return np.array([vector["x"], vector["y"], vector["z"]])


def test_feet_and_trunk_are_where_they_were(updates):
    estimate = load(CLIP)["state/estimate"]
    assert len(updates) == 1 + int(0.94 * RATE_HZ)
    for t, entities in updates:
        robot = entities["robot"]
        assert robot["timestamp"]["sec"] + robot["timestamp"]["nsec"] / 1e9 == pytest.approx(t)
        (row,) = estimate.at(np.array([t]))
        feet = [xyz(sphere["pose"]["position"]) for sphere in robot["spheres"]]
        np.testing.assert_allclose(feet, estimate["p_WF"][row])
        np.testing.assert_allclose(xyz(robot["cubes"][0]["pose"]["position"]), estimate["p_WB"][row])


def test_a_leg_is_as_long_as_its_links(updates):
    robot = load(CLIP).deployment.load_robot()
    for line in updates[0][1]["robot"]["lines"]:
        _, thigh, knee, foot = (xyz(point) for point in line["points"])
        assert np.linalg.norm(knee - thigh) == pytest.approx(robot.thigh_length)
        assert np.linalg.norm(foot - knee) == pytest.approx(robot.calf_length, abs=1e-6)


def test_an_arrow_points_where_the_force_does(updates):
    t, entities = updates[2]
    estimate = load(CLIP)["state/estimate"]
    (row,) = estimate.at(np.array([t]))
    forces = [force for force in estimate["force_W"][row] if np.linalg.norm(force) > 5.0]
    arrows = entities["robot"]["arrows"]
    assert len(arrows) == len(forces) >= 3
    for arrow, force in zip(arrows, forces, strict=True):
        turn = arrow["pose"]["orientation"]
        along = matrix_of(np.array([turn["w"], turn["x"], turn["y"], turn["z"]]))[:, 0]
        np.testing.assert_allclose(along, force / np.linalg.norm(force), atol=1e-9)


def test_a_verdict_is_marked_from_then_on(updates):
    marked = [t for t, entities in updates if entities["verdicts"]["cylinders"]]
    assert marked[0] == pytest.approx(23.2) and marked[-1] == updates[-1][0]
