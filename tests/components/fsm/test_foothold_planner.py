"""Targets and base poses: the nominal configuration, reach, lowering."""

import numpy as np
import pytest

from surefoot.components.fsm.foothold_planner import FootholdPlanner, plane_height
from surefoot.components.fsm.support_triangle import SupportTriangle
from surefoot.components.robot_model.rotation import matrix_of_rpy
from surefoot.config.fsm import Fsm
from surefoot.config.robot import load_robot

UP = np.array([0.0, 0.0, 1.0])
AHEAD = np.array([0.025, 0.0, 0.0])
SETTINGS = Fsm()


@pytest.fixture(scope="module")
def planner():
    return FootholdPlanner(load_robot("aliengo"), SETTINGS)


def feet_under(planner, yaw=0.0):
    level = planner.nominal_BF.copy()
    level[:, 2] = 0.0265
    return level @ matrix_of_rpy(np.array([0.0, 0.0, yaw])).T


def test_targets_of_the_nominal_stance_are_its_feet(planner):
    for yaw in (0.0, 0.7):
        feet = feet_under(planner, yaw)
        np.testing.assert_allclose(planner.centre(feet, yaw), np.zeros(2), atol=1e-12)
        np.testing.assert_allclose(planner.targets(feet, np.zeros(2), yaw, UP), feet, atol=1e-12)


def test_the_base_is_level_with_a_slope_under_it(planner):
    normal = np.array([-0.1, 0.05, 1.0])
    normal /= np.linalg.norm(normal)
    feet = feet_under(planner)
    feet[:, 2] = 0.0265 - feet[:, :2] @ normal[:2] / normal[2]
    pose = planner.pose(np.zeros(2), feet, normal, 0.0)
    np.testing.assert_allclose(matrix_of_rpy(pose[3:])[:, 2], normal, atol=2e-3)
    assert plane_height(feet, normal, np.array([[0.1, 0.2]]))[0] == pytest.approx(
        0.0265 - (0.1 * normal[0] + 0.2 * normal[1]) / normal[2]
    )


def test_the_support_pose_keeps_the_centre_of_mass_inside(planner):
    feet = feet_under(planner)
    for leg in range(4):
        goal = feet[leg] + [0.10, 0.0, 0.0]
        pose = planner.support_pose(leg, goal, feet, UP, 0.0, np.zeros(3), AHEAD)
        margin = SupportTriangle(feet, leg).margin(pose[:2])
        assert margin >= SETTINGS.margin_m + SETTINGS.margin_extra_m - 1e-9
        reached = feet.copy()
        reached[leg] = goal + AHEAD
        assert planner.leg_lengths(pose, reached).max() <= SETTINGS.leg_length_plan_m


def test_a_far_foothold_lowers_the_base_and_a_farther_one_is_refused(planner):
    feet = feet_under(planner)
    near = planner.support_pose(1, feet[1] + [0.10, 0, 0], feet, UP, 0.0, np.zeros(3), AHEAD)
    far = planner.support_pose(1, feet[1] + [0.25, 0, 0], feet, UP, 0.0, np.zeros(3), AHEAD)
    assert far[2] < near[2] - 0.01
    assert planner.support_pose(1, feet[1] + [0.60, 0, 0], feet, UP, 0.0, np.zeros(3), AHEAD) is None


def test_ground_that_may_lie_deep_is_within_the_leg_at_its_full_length(planner):
    feet = feet_under(planner)
    goal, depth = feet[1] + [0.20, 0.0, 0.0], 0.10
    level = planner.support_pose(1, goal, feet, UP, 0.0, np.zeros(3), AHEAD)
    deep = planner.support_pose(1, goal, feet, UP, 0.0, np.zeros(3), AHEAD, depth)
    assert deep[2] < level[2] - 0.005
    reached = feet.copy()
    reached[1] = goal + AHEAD - depth * UP
    assert planner.leg_lengths(level, reached)[1] > SETTINGS.leg_length_max_m
    assert planner.leg_lengths(deep, reached)[1] <= SETTINGS.leg_length_max_m
