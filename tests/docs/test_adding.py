"""The terrain and the robot of the pages are added as the pages say, and are what the pages say."""

import re
import shutil

import pytest
from followed import Followed
from markdown_pages import ROOT

from surefoot.config import robot as robot_file
from surefoot.config.deployment import load_deployment
from surefoot.config.typed_toml import ConfigError

CLIMBED = """
from surefoot.config.deployment import load_deployment
from surefoot.hw.mujoco.backend import MujocoRobot
deployment = load_deployment("config/stairs.toml", ["terrain.stairs.rise_min_m=0.02"])
robot = MujocoRobot(deployment)
stairs, field = deployment.terrain.stairs, robot.field
assert field.end_x - field.start_x == stairs.count * stairs.tread_m
end_z = field.level(field.end_x + 0.1)
assert stairs.count * stairs.rise_min_m <= end_z <= stairs.count * stairs.rise_max_m
assert robot.model.geom("stair_1").pos[0] > robot.model.geom("stair_0").pos[0]
"""
ROBOT_PAGE = (ROOT / "docs" / "adding_a_robot.md").read_text()
REFUSED = re.findall(r"^\| `(\w+ = .*?)` \| (\S.*\S) \|$", ROBOT_PAGE, re.MULTILINE)


@pytest.fixture(scope="module")
def tree(tmp_path_factory):
    """The tree with `stairs`."""
    return Followed(tmp_path_factory.mktemp("tree"), ROOT / "docs" / "adding_a_terrain.md")


def test_the_terrain_is_built(tree):
    tree.python("-c", CLIMBED)


def test_the_terrain_is_a_section_of_a_lane(tree):
    change = 'terrain.lane.sections=["stairs", "stairs"]'
    tree.python(
        "-c",
        "from surefoot.config.deployment import load_deployment\n"
        "from surefoot.hw.mujoco.backend import MujocoRobot\n"
        f"names = MujocoRobot(load_deployment('config/lane.toml', [{change!r}])).model\n"
        "assert names.geom('0_stair_0') is not None and names.geom('1_stair_0') is not None",
    )


@pytest.fixture
def mine(tmp_path, monkeypatch):
    """A copy of Aliengo's figures under another name; changed, and read in a deployment."""
    folder = tmp_path / "config"
    shutil.copytree(ROOT / "config" / "robots", folder / "robots")
    figures = (folder / "robots" / "aliengo.toml").read_text().replace('name = "aliengo"', 'name = "mine"')
    monkeypatch.setattr(robot_file, "__file__", str(folder / "robot.py"))

    def read(change=""):
        key = change.split(" = ")[0]
        changed = re.sub(rf"^{key} = [^#\n]*", change, figures, count=1, flags=re.MULTILINE) if change else figures
        assert not change or changed != figures, f"no {key} in the file"
        (folder / "robots" / "mine.toml").write_text(changed)
        robot_file.load_robot.cache_clear()  # a process reads a robot once
        return load_deployment(ROOT / "config" / "flat.toml", ["robot=mine"])

    return read


def test_a_copy_of_a_robot_is_one(mine):
    assert mine().load_robot().name == "mine"


@pytest.mark.parametrize(("change", "words"), REFUSED)
def test_what_cannot_be_is_refused_as_the_page_says(mine, change, words):
    with pytest.raises(ConfigError) as refused:
        mine(change)
    assert words in str(refused.value)


def test_the_page_has_refusals_of_both_kinds():
    assert len(REFUSED) >= 8
