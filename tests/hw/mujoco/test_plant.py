"""The simulated robot differs from its model as the seed and the settings say, and only there."""

import dataclasses

import mujoco
import numpy as np
import pinocchio as pin
import pytest

from surefoot.components.lockstep import Lockstep
from surefoot.components.robot_model import build_model
from surefoot.config.deployment import Deployment
from surefoot.config.hw import Hw
from surefoot.config.robot import load_robot
from surefoot.hw.mujoco.backend import MujocoRobot
from surefoot.hw.mujoco.plant import draw_plant, stream
from surefoot.hw.mujoco.scene import build_scene

ROBOT = load_robot("aliengo")
SEEDS = range(300)


def drawn(seed, **settings):
    return draw_plant(ROBOT, Hw(seed=seed, **settings))


def figures(plant):
    """All that is drawn: mass ratio, centre of mass offset, friction, biases."""
    trunk, nominal = plant.robot.trunk, ROBOT.trunk
    offset = np.array(trunk.com) - nominal.com
    return np.array([trunk.mass / nominal.mass - 1.0, *offset, plant.friction, *plant.gyro_bias, *plant.acc_bias])


def first_moment(link):
    return link.mass * np.array(link.com)


def test_a_seed_repeats_itself_and_no_other():
    np.testing.assert_array_equal(figures(drawn(3)), figures(drawn(3)))
    table = np.array([figures(drawn(seed)) for seed in SEEDS])
    for column in table.T:
        assert len(np.unique(column)) == len(SEEDS)


def test_draws_fill_their_ranges_and_keep_inside():
    table = np.array([figures(drawn(seed, friction_min=0.3, friction_max=0.9)) for seed in SEEDS])
    ends = np.array([[-0.05, 0.05], *3 * [[-0.01, 0.01]], [0.3, 0.9]])
    share = (table[:, :5] - ends[:, 0]) / (ends[:, 1] - ends[:, 0])
    # Of 300 uniform draws the extremes are within 5 % of the ends but for one case in a million.
    assert ((share.min(axis=0) >= 0.0) & (share.min(axis=0) < 0.05)).all()
    assert ((share.max(axis=0) <= 1.0) & (share.max(axis=0) > 0.95)).all()
    # The standard deviation of 900 normal draws is known to 2 %.
    np.testing.assert_allclose(table[:, 5:8].std(), Hw().gyro_bias, rtol=0.1)
    np.testing.assert_allclose(table[:, 8:11].std(), Hw().acc_bias, rtol=0.1)


def test_quantities_are_drawn_apart():
    # Neither does a setting of one change another, nor are two of them the same numbers in disguise.
    plain, heavier = figures(drawn(5)), figures(drawn(5, trunk_mass_error=0.3))
    assert heavier[0] == pytest.approx(6.0 * plain[0])
    np.testing.assert_array_equal(heavier[1:], plain[1:])
    table = np.array([figures(drawn(seed)) for seed in SEEDS])
    between = np.corrcoef(table.T) - np.eye(table.shape[1])
    assert np.abs(between).max() < 0.3
    assert not np.allclose(stream(0, "q").normal(size=5), stream(0, "dq").normal(size=5))


def test_settings_of_zero_leave_the_model():
    exact = drawn(9, trunk_mass_error=0.0, com_error_m=0.0, gyro_bias=0.0, acc_bias=0.0)
    assert exact.robot == ROBOT
    np.testing.assert_array_equal(np.concatenate([exact.gyro_bias, exact.acc_bias]), 0.0)


def test_nothing_but_the_trunk_differs():
    plant = drawn(4)
    assert dataclasses.replace(plant.robot, trunk=ROBOT.trunk) == ROBOT
    scale = plant.robot.trunk.mass / ROBOT.trunk.mass
    np.testing.assert_allclose(plant.robot.trunk.inertia, scale * np.array(ROBOT.trunk.inertia))


@pytest.mark.parametrize("seed", [0, 1])
def test_what_is_drawn_reaches_the_simulation(seed):
    deployment = Deployment(hw=Hw(seed=seed))
    plant, true = drawn(seed), MujocoRobot(deployment)
    model = true.model
    nominal, _ = build_scene(deployment, ROBOT, friction=0.6)
    trunk = model.body("trunk").id
    assert model.body_mass[trunk] == pytest.approx(plant.robot.trunk.mass)
    assert abs(model.body_mass[trunk] - nominal.body_mass[trunk]) > 1e-3
    np.testing.assert_allclose(model.body_ipos[trunk], plant.robot.trunk.com)
    np.testing.assert_allclose(model.geom_friction[:, 0], plant.friction)
    # Principal moments grow with the mass; every other link is as it was.
    scale = plant.robot.trunk.mass / ROBOT.trunk.mass
    np.testing.assert_allclose(model.body_inertia[trunk], scale * nominal.body_inertia[trunk])
    others = np.arange(model.nbody) != trunk
    np.testing.assert_array_equal(model.body_mass[others], nominal.body_mass[others])
    np.testing.assert_array_equal(model.body_ipos[others], nominal.body_ipos[others])
    # The centre of mass of the whole robot in one posture moves by the trunk's share.
    data = [mujoco.MjData(each) for each in (model, nominal)]
    for each, scene in zip(data, (model, nominal), strict=True):
        each.qpos[:] = true.data.qpos
        mujoco.mj_forward(scene, each)
    R_WB = data[0].xmat[trunk].reshape(3, 3)
    moment = first_moment(plant.robot.trunk) - first_moment(ROBOT.trunk)
    p_WB, mass, heavier = true.data.qpos[:3], nominal.body_mass.sum(), model.body_mass.sum()
    expected = p_WB + (mass * (data[1].subtree_com[trunk] - p_WB) + R_WB @ moment) / heavier
    np.testing.assert_allclose(data[0].subtree_com[trunk], expected, atol=1e-9)
    np.testing.assert_allclose(true.truth().com_W, expected, atol=1e-9)


def test_biases_reach_the_sensors():
    quiet = {"gyro_noise": 0.0, "acc_noise": 0.0}
    biased = MujocoRobot(Deployment(hw=Hw(seed=2, **quiet))).read()
    unbiased = MujocoRobot(Deployment(hw=Hw(seed=2, gyro_bias=0.0, acc_bias=0.0, **quiet))).read()
    plant = drawn(2)
    np.testing.assert_allclose(biased.omega_WB_B - unbiased.omega_WB_B, plant.gyro_bias, atol=1e-12)
    np.testing.assert_allclose(biased.acc_B - unbiased.acc_B, plant.acc_bias, atol=1e-12)


def test_the_controllers_model_stays_what_the_robots_file_says():
    nominal = build_model(load_robot("aliengo"))
    stacks = [Lockstep(Deployment(hw=Hw(seed=seed))) for seed in (0, 1)]
    truly = [stack.components["io"].robot.model.body_mass.sum() for stack in stacks]
    assert truly[0] != truly[1] and pin.computeTotalMass(nominal) not in truly
    for stack in stacks:
        models = [value for part in stack.components.values() for value in within(part, pin.Model)]
        assert len(models) >= 3  # estimator, MPC and whole-body control at least
        for model in models:
            assert pin.computeTotalMass(model) == pin.computeTotalMass(nominal)
            for inertia, own in zip(nominal.inertias, model.inertias, strict=True):
                np.testing.assert_array_equal(own.lever, inertia.lever)
                np.testing.assert_array_equal(own.inertia, inertia.inertia)


def within(part, kind, seen=None):
    """Every object of a kind that a component holds, directly or in what it holds."""
    seen = set() if seen is None else seen
    if id(part) in seen:
        return
    seen.add(id(part))
    if isinstance(part, kind):
        yield part
    elif hasattr(part, "__dict__") and type(part).__module__.startswith("surefoot"):
        for value in vars(part).values():
            yield from within(value, kind, seen)
