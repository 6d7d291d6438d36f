"""Rigid ground with one step down, where the seed puts it."""

import numpy as np
import pytest

from surefoot.config.deployment import Deployment
from surefoot.config.hw import Hw
from surefoot.config.terrain import Edge, Terrain
from surefoot.hw.mujoco.press_test import PressTest
from surefoot.hw.mujoco.scene import build_scene

EDGE = Edge()


def deployment(seed=0, **settings):
    return Deployment(terrain=Terrain(kind="edge", edge=Edge(**settings)), hw=Hw(seed=seed))


def drop_of(field):
    """(x, height) of the drop of a field [m]."""
    _, (x, z0), (x_low, z1), _ = field.profile
    assert x == x_low
    return x, z0 - z1


@pytest.mark.parametrize("seed", range(3))
def test_the_ground_drops_where_the_field_says(seed):
    press = PressTest(deployment(seed))
    _, field = build_scene(deployment(seed), None, 0.6)
    x, drop = drop_of(field)
    for y in (-0.2, 0.0, 0.2):
        assert press.surface(x - 0.001, y) == pytest.approx(0.0, abs=1e-9)
        for beyond in (0.001, 0.3, 1.2):
            assert press.surface(x + beyond, y) == pytest.approx(-drop, abs=1e-9)
    assert field.level(x - 0.001) == 0.0 and field.level(x + 0.001) == pytest.approx(-drop)
    for where in (x - 0.03, x + 0.05):
        assert press.press(where, 0.1, 150.0).displacement_m < 2e-3, "all of it is rigid"


def test_place_and_depth_are_drawn_within_their_limits():
    robot = Deployment().load_robot()
    front_x = robot.legs["FL"].hip_p_B[0] + robot.foot.radius
    drawn = np.array([drop_of(build_scene(deployment(seed), None, 0.6)[1]) for seed in range(30)])
    ahead, drop = drawn[:, 0] - front_x, drawn[:, 1]
    assert (np.abs(ahead - EDGE.distance_m) <= EDGE.distance_spread_m).all()
    assert np.ptp(ahead) > EDGE.distance_spread_m
    assert (drop >= 0.02).all() and (drop <= 0.04).all() and np.ptp(drop) > 0.01


def test_a_foot_set_down_a_step_ahead_lands_within_its_pad_of_the_drop_in_many_runs():
    # Else nothing here would tell whether a robot probes around its footholds.
    robot = Deployment().load_robot()
    landing_x = robot.legs["FL"].hip_p_B[0] + Deployment().fsm.step_m
    before = np.array([drop_of(build_scene(deployment(seed), None, 0.6)[1])[0] - landing_x for seed in range(10)])
    near = (before > 0.0) & (before < Deployment().fsm.around_radius_m)
    assert near.sum() >= 3
