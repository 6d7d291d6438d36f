"""A picture shows the instant it was asked for; what is missing of a renderer is told, and costs nothing else."""

import numpy as np
import pytest

from surefoot.hw.mujoco.backend import MujocoRobot
from surefoot.tools.reproduce.recording.instants import joint_positions
from surefoot.tools.reproduce.run_spec import RunSpec
from surefoot.tools.reproduce.snapshots import SIZE, Darkroom, Shot, on_foot

SPEC = RunSpec("planks", "full", 0, 1.0, ())


@pytest.fixture(scope="module")
def start():
    return MujocoRobot(SPEC.deployment()).truth()


def test_a_plank_that_is_down_is_seen(start, tmp_path):
    image = pytest.importorskip("PIL.Image")
    level, down = joint_positions(start), joint_positions(start)
    down[19] = 0.8  # the first plank
    where = on_foot(start.p_WF[1], 1)
    shots = [Shot(level, where, tmp_path / "level.jpg"), Shot(down, where, tmp_path / "down.jpg")]
    missing = Darkroom().develop(SPEC, shots)
    if "no renderer" in missing:
        pytest.skip(missing)
    assert missing == ""
    first, second = (np.asarray(image.open(shot.path)).astype(int) for shot in shots)
    assert first.shape == (SIZE[1], SIZE[0], 3) and first.std() > 20.0
    changed = np.abs(first - second).max(axis=2) > 30
    assert 0.002 < changed.mean() < 0.3


def test_positions_of_another_scene_are_no_fault_of_the_renderer(start, tmp_path):
    shot = Shot(joint_positions(start)[:-1], on_foot(start.p_WF[1], 1), tmp_path / "one.jpg")
    missing = Darkroom().develop(SPEC, [shot])
    if "no renderer" in missing:
        pytest.skip(missing)
    assert missing.startswith("not rendered: error: ValueError")


def test_every_backend_is_tried_and_named(start, tmp_path, monkeypatch):
    monkeypatch.delenv("MUJOCO_GL", raising=False)
    shot = Shot(joint_positions(start), on_foot(start.p_WF[1], 1), tmp_path / "one.jpg")
    room = Darkroom(["chalk", "coal"])
    missing = room.develop(SPEC, [shot])
    assert missing.startswith("no renderer on this machine (chalk: ") and "; coal: " in missing
    assert room.develop(SPEC, [shot]) == missing and not list(tmp_path.iterdir())
    assert room.develop(SPEC, []) == ""
