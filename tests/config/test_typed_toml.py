"""A configuration that cannot be meant is refused, and the message says which key."""

import shutil
from pathlib import Path

import pytest

import surefoot.config.robot as robot_module
from surefoot.config.deployment import load_deployment
from surefoot.config.robot import Robot, load_robot
from surefoot.config.typed_toml import ConfigError, build, read_toml

ALIENGO = Path(robot_module.__file__).parent / "robots" / "aliengo.toml"


def deployment(tmp_path, text, overrides=()):
    path = tmp_path / "test.toml"
    path.write_text(text)
    return load_deployment(path, overrides)


def test_sections_override_defaults(tmp_path):
    result = deployment(tmp_path, "[hw]\nseed = 3\n", ["hw.torque_noise=0", "terrain.kind=planks"])
    assert (result.hw.seed, result.hw.torque_noise, result.terrain.kind) == (3, 0.0, "planks")


def test_a_part_of_a_section_leaves_the_rest_as_it_is(tmp_path):
    result = deployment(tmp_path, "", ["ocp.friction_cone.mu=5.0"]).ocp
    assert (result.friction_cone.mu, result.friction_cone.delta) == (5.0, 0.1)
    with pytest.raises(ConfigError, match=r"ocp\.friction_cone\.delta = 0"):
        deployment(tmp_path, "", ["ocp.friction_cone.delta=0"])


@pytest.mark.parametrize(
    ("text", "named"),
    [
        ("[hw]\nsed = 3\n", r"hw\.sed: unknown key"),
        ("[hv]\nseed = 3\n", r"hv: unknown key"),
        ("[hw]\nseed = 'x'\n", r"hw\.seed = 'x': expected int"),
        ("[hw]\nseed = true\n", r"hw\.seed = True: expected int"),
        ("[terrain]\nkind = 'ice'\n", r"terrain\.kind = 'ice': must be one of"),
        ("hw = 4\n", r"hw: expected a table"),
        ("[hw\n", "not valid TOML"),
    ],
)
def test_mistakes_are_named_by_their_path(tmp_path, text, named):
    with pytest.raises(ConfigError, match=named):
        deployment(tmp_path, text)


def test_a_missing_file_and_a_bad_override_are_named(tmp_path):
    with pytest.raises(ConfigError, match="no such file"):
        load_deployment(tmp_path / "none.toml")
    with pytest.raises(ConfigError, match=r"section\.key=value"):
        deployment(tmp_path, "", ["hw.seed"])


def test_a_robot_with_a_wrong_joint_or_a_missing_figure_is_named():
    table = read_toml(ALIENGO)
    table["joints"]["knee"] = table["joints"].pop("calf")
    with pytest.raises(ConfigError, match=r"joints\.calf: missing"):
        build(Robot, table)
    table = read_toml(ALIENGO)
    del table["legs"]["RL"]["thigh"]["com"]
    with pytest.raises(ConfigError, match=r"legs\.RL\.thigh\.com: missing"):
        build(Robot, table)
    with pytest.raises(ConfigError, match="known: aliengo"):
        load_robot("spot")


def test_another_robot_is_another_file(tmp_path, monkeypatch):
    (tmp_path / "robots").mkdir()
    shutil.copy(ALIENGO, tmp_path / "robots" / "longlegs.toml")
    monkeypatch.setattr(robot_module, "__file__", str(tmp_path / "robot.py"))
    assert load_robot("longlegs").mass == pytest.approx(24.937)
