"""Every deployment's terrain compiles, bears the robot's start and is the same for the same seed."""

from dataclasses import replace
from pathlib import Path

import mujoco
import numpy as np
import pytest

import surefoot.config.deployment as deployment_module
from surefoot.config.deployment import load_deployment
from surefoot.config.robot import GRAVITY, JOINT_NAMES
from surefoot.hw.mujoco.backend import MujocoRobot
from surefoot.hw.mujoco.scene import build_scene
from surefoot.hw.mujoco.terrain import Field
from surefoot.hw.robot_interface import MotorLaw

CONFIG = Path(deployment_module.__file__).parent
DEPLOYMENTS = sorted(path.stem for path in CONFIG.glob("*.toml"))


def deployment(name, seed=0):
    read = load_deployment(CONFIG / f"{name}.toml")
    return replace(read, hw=replace(read.hw, seed=seed))


def bytes_of(model):
    buffer = np.zeros(mujoco.mj_sizeModel(model), np.uint8)
    mujoco.mj_saveModel(model, None, buffer)
    return buffer.tobytes()


@pytest.fixture(scope="module", params=DEPLOYMENTS)
def stood(request):
    """A robot that has held its posture for a while."""
    machine = MujocoRobot(deployment(request.param))
    one = np.ones(12)
    law = MotorLaw(q=machine.truth().q, dq=0.0 * one, kp=300.0 * one, kd=8.0 * one, tau=0.0 * one)
    for _ in range(100):
        machine.write(law)
        machine.advance()
    return request.param, machine


def test_the_robot_stands_on_its_run_up(stood):
    _, machine = stood
    truth = machine.truth()
    weight = machine.model.body_mass[machine.model.body_rootid == machine.model.body("trunk").id].sum() * GRAVITY
    assert truth.body_contact == ""
    assert truth.force_W[:, 2].sum() == pytest.approx(weight, rel=0.02)
    np.testing.assert_allclose(truth.p_WF[:, 2], machine.field.level(0.0) + 0.0265, atol=2e-3)
    assert truth.p_WF[:, 0].max() < machine.field.start_x


def test_the_robots_joints_come_first(stood):
    _, machine = stood
    assert tuple(machine.model.joint(index).name for index in range(1, 13)) == JOINT_NAMES
    assert machine.model.joint("base").qposadr[0] == 0
    assert len(machine.truth().terrain_q) == machine.model.nq - 19


def test_the_terrain_rests_until_the_robot_comes(stood):
    _, machine = stood
    started = machine.model.qpos0[19:]
    np.testing.assert_allclose(machine.truth().terrain_q, started, atol=1e-3)
    begins_asleep = machine.model.tree_sleep_policy == mujoco.mjtSleepPolicy.mjSLEEP_INIT
    assert not machine.data.tree_awake[begins_asleep].any(), "or it costs more than flat ground"


def test_ground_lies_before_and_behind(stood):
    name, machine = stood
    field, model, data = machine.field, machine.model, machine.data
    trunk, hit = model.body("trunk").id, np.zeros(1, np.int32)
    for x in (-0.4, field.start_x - 0.01, field.end_x + 0.01, field.end_x + 0.7):
        above = np.array([x, 0.4, 5.0])
        distance = mujoco.mj_ray(model, data, above, np.array([0.0, 0.0, -1.0]), None, 1, trunk, hit)
        assert 5.0 - distance == pytest.approx(field.level(x), abs=1e-6), f"{name} at x = {x}"


@pytest.mark.parametrize("name", DEPLOYMENTS)
def test_the_same_seed_the_same_scene(name):
    def scene(seed):
        return bytes_of(build_scene(deployment(name, seed), None, 0.6)[0])

    one = scene(1)
    assert one == scene(1)
    terrain = deployment(name, 1).terrain
    drawn = terrain.kind not in ("flat", "planks") or terrain.planks.missing_count > 0
    assert (one != scene(2)) == drawn


def test_the_level_of_a_surface_with_an_incline_and_a_step():
    field = Field(1.0, 4.0, ((1.0, 0.0), (2.0, 0.5), (3.0, 0.5), (3.0, 0.4), (4.0, 0.4)))
    levels = {0.0: 0.0, 1.0: 0.0, 1.5: 0.25, 2.0: 0.5, 2.9: 0.5, 3.0: 0.4, 3.5: 0.4, 4.0: 0.4, 9.0: 0.4}
    assert {x: field.level(x) for x in levels} == pytest.approx(levels)
    assert Field(0.3, 0.8).level(0.5) == 0.0
