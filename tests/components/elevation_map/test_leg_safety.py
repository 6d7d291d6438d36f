"""Walls that foot or leg would meet, and places that the leg cannot reach, by geometry of the test's own."""

import numpy as np
import pytest
from made_up_ground import CELL, NOMINAL_BF, RADIUS, ROBOT, Ground, flagged, standing_at

from surefoot.bus.messages import Unsafe

LINK = 0.25  # thigh and calf alike
CLEARANCE = 0.02
OFF_CENTRE = CELL / np.sqrt(2.0)  # a point of the leg is looked up in the cell that it is in


def side_view(foot_x, foot_z, thigh_x, thigh_z):
    """(2,) knee of a leg in its plane, bent backwards."""
    foot, thigh = np.array([foot_x, foot_z]), np.array([thigh_x, thigh_z])
    way = foot - thigh
    length = np.linalg.norm(way)
    back = np.array([way[1], -way[0]]) / length  # to the left of the way down, towards -x
    return (foot + thigh) / 2.0 + back * np.sqrt(LINK**2 - length**2 / 4.0)


def gap_to_wall(start, end, first, wall_x, wall_z):
    """Distance of the way from `first` of start..end, in the x-z plane, to a wall one cell thick."""
    points = start + np.linspace(first, 1.0, 400)[:, None] * (end - start)
    dx = np.maximum(np.abs(points[:, 0] - wall_x) - CELL / 2, 0.0)
    return np.hypot(dx, np.maximum(points[:, 1] - wall_z, 0.0)).min()


def wall(at, height):
    return Ground(lambda x, y: np.where(np.abs(x - at) < CELL / 2, height, 0.0))


@pytest.mark.parametrize("height", [0.12, 0.17, 0.22])
def test_a_wall_behind_is_met_by_the_leg_that_leans_over_it(height):
    """The swing comes from ahead; the calf of cells near the wall, which lies behind them all, would touch it."""
    asked = standing_at(0.2, 0.2, step=-0.1)
    at = 0.02  # two cells behind the heightmap, which ends at 0.05
    found = flagged(wall(at, height).ask(**asked), Unsafe.LEG)[:, 7]  # the leg's own plane: no abduction
    thigh_z = RADIUS - NOMINAL_BF[0, 2]
    surely = never = 0
    for i in range(15):
        foot = np.array([0.2 + CELL * (i - 7), RADIUS])
        knee = side_view(*foot, 0.2, thigh_z)
        calf = gap_to_wall(foot, knee, 2.0 * RADIUS / LINK, at, height) - 0.0104
        thigh = gap_to_wall(knee, np.array([0.2, thigh_z]), 0.0, at, height) - 0.0215
        gap = min(calf, thigh)
        if gap < CLEARANCE - OFF_CENTRE:
            surely += 1
            assert found[i], (i, gap)
        elif gap > CLEARANCE + OFF_CENTRE:
            never += 1
            assert not found[i], (i, gap)
    assert surely >= 2 and never >= 2


@pytest.mark.parametrize(("height", "met"), [(0.25, False), (0.36, True)])
def test_a_wall_under_a_thigh_that_reaches_back_is_met_if_it_is_high_enough(height, met):
    """Foot, calf and the whole swing are behind the wall; only the thigh goes forward over it to its axis."""
    at = 0.16
    found = flagged(wall(at, height).ask(**standing_at(0.2, 0.2, step=0.14)), Unsafe.LEG)[:, 7]
    for i in (0, 1):
        foot, thigh = np.array([0.2 + CELL * (i - 7), RADIUS]), np.array([0.2, RADIUS - NOMINAL_BF[0, 2]])
        knee = side_view(*foot, *thigh)
        assert gap_to_wall(foot, knee, 0.0, at, height) > 0.0104 + CLEARANCE + OFF_CENTRE
        gap = gap_to_wall(knee, thigh, 0.0, at, height) - 0.0215
        assert gap < CLEARANCE - OFF_CENTRE if met else gap > CLEARANCE + OFF_CENTRE
        assert found[i] == met


@pytest.mark.parametrize(("height", "met"), [(0.04, False), (0.075, True), (0.2, True)])
def test_a_wall_on_the_way_is_met_if_it_is_higher_than_the_swing_clears(height, met):
    """From 20 cm ahead the foot goes back, 8 cm high, over a wall half way; the calf is never near it."""
    asked = standing_at(0.2, 0.2, step=-0.2)
    answer = wall(0.3, height).ask(**asked)
    assert flagged(answer, Unsafe.LEG)[5:9, 4:11].all() == met
    assert flagged(answer, Unsafe.LEG)[5:9, 4:11].any() == met
    # Without the way over it the same cells are as good as any.
    beside = wall(0.3, height).ask(**standing_at(0.2, 0.2, step=0.1))
    assert not flagged(beside, Unsafe.LEG)[:9].any()


def test_the_swing_goes_to_each_cell_and_not_only_to_the_target():
    """A post beside the straight way is met only on the ways to the cells behind it."""
    asked = standing_at(0.2, 0.2, step=-0.24)
    post = Ground(lambda x, y: np.where((np.abs(x - 0.32) < 0.011) & (np.abs(y - 0.28) < 0.011), 0.3, 0.0))
    met = flagged(post.ask(**asked), Unsafe.LEG)
    assert met[5, 14] and not met[5, 0] and not met[5, 5]


def test_ground_that_is_not_known_is_met_by_nothing():
    asked = standing_at(0.2, 0.2, step=-0.2)
    ground = wall(0.3, 0.2)
    ground.height[ground.height > 0.1] = np.nan
    assert not flagged(ground.ask(**asked), Unsafe.LEG).any()


def test_a_wall_of_the_step_up_is_cleared_from_its_edge_on():
    """On to a platform 8 cm high: what the disc allows, the leg can reach without touching its wall."""
    asked = standing_at(0.2, 0.2, z=0.0, step=0.16)
    answer = Ground(lambda x, y: np.where(x > 0.15, 0.08, 0.0)).ask(**asked)
    assert not flagged(answer, Unsafe.EDGE | Unsafe.LEG)[8:, 7].any()
    assert answer.safe[0] and answer.foothold_WF[0, 2] == pytest.approx(0.08 + RADIUS)


def lengths(z, legs_y):
    """(15, 15) thigh axis to foot of a leg whose thigh axis is z above the middle cell's foot centre.

    Abduction turns the leg about an axis `legs_y` inwards of the thigh's.
    """
    offsets = CELL * (np.arange(15) - 7)
    dx, dy = np.meshgrid(offsets, offsets, indexing="ij")
    return np.sqrt(dx**2 + (legs_y + dy) ** 2 + z**2 - legs_y**2)


@pytest.mark.parametrize("rise", [0.06, 0.08])
def test_what_is_farther_than_the_longest_leg_is_out_of_reach(rise):
    asked = standing_at(0.2, 0.2)
    asked["base"][2] += rise
    answer = Ground().ask(**asked)
    side = ROBOT.legs["FL"].thigh_p_hip[1]
    length = lengths(rise - NOMINAL_BF[0, 2], side)
    assert np.abs(length - 0.47).min() > 1e-6
    far = length > 0.47
    assert 4 <= far.sum() <= 221
    np.testing.assert_array_equal(flagged(answer, Unsafe.REACH), far)
    # The right leg abducts the other way.
    right = flagged(answer, Unsafe.REACH, leg=1)
    assert right.sum() > 0 and right[:, 0].sum() > right[:, -1].sum() and far[:, -1].sum() > far[:, 0].sum()


def test_a_place_that_no_posture_reaches_is_out_of_reach_however_near():
    asked = standing_at(0.2, 0.2)
    asked["base"][2] -= 0.32
    answer = Ground().ask(**asked)
    assert flagged(answer, Unsafe.REACH)[7, 7]


def test_the_reach_turns_with_the_base():
    asked = standing_at(0.2, 0.2)
    asked["base"][2] += 0.08
    level = flagged(Ground().ask(**asked), Unsafe.REACH)
    assert not np.array_equal(level, level.T)
    target = asked["targets"][0]
    quarter = np.array([[0.0, -1.0, 0.0], [1.0, 0.0, 0.0], [0.0, 0.0, 1.0]])
    turned = {name: target + (asked[name] - target) @ quarter.T for name in ("targets", "feet")}
    turned["base"] = np.append(target + quarter @ (asked["base"][:3] - target), [0.0, 0.0, np.pi / 2.0])
    np.testing.assert_array_equal(flagged(Ground().ask(**turned), Unsafe.REACH), level.T[::-1])
