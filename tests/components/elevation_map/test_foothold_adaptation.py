"""The answer to a request: nearest safe cell, convex region, held load, and what there is without a map."""

import dataclasses

import numpy as np
import pytest
from made_up_ground import CELL, NOMINAL_BF, RADIUS, ROBOT, Ground, flagged, standing_at

from surefoot.bus.codec import decode, encode
from surefoot.bus.messages import FootholdRegions, Unsafe
from surefoot.components.elevation_map.foothold_adaptation import FootholdAdaptation
from surefoot.components.robot_model.rotation import matrix_of_rpy
from surefoot.config.elevation_map import ElevationMap, Vfa
from surefoot.config.fsm import Fsm

AT = standing_at(0.2, 0.2)


def boxes(answer, leg):
    """Low and high corner (2,) of a leg's region, from its half-spaces."""
    A, b = answer.region_a[leg], answer.region_b[leg]
    np.testing.assert_array_equal(A, [[1, 0, 0], [-1, 0, 0], [0, 1, 0], [0, -1, 0]])
    return np.array([-b[0], -b[2]]), np.array([b[1], b[3]])


def centres(answer, leg):
    """(15, 15, 2) centres of a heightmap's cells."""
    steps = answer.cell_m * np.arange(15)
    x, y = np.meshgrid(*(answer.heightmap_p_W[leg] + steps[:, None]).T, indexing="ij")
    return np.stack([x, y], axis=-1)


def nearest(answer, leg, target):
    """Centre of the safe cell nearest the target, by looking at one after the other."""
    best, where = np.inf, None
    for cell, centre in zip(
        answer.heightmap_unsafe[leg].ravel(), centres(answer, leg).reshape(-1, 2), strict=True
    ):
        distance = np.hypot(*(centre - target[:2]))
        if cell == 0 and distance < best - 1e-9:
            best, where = distance, centre
    return where


def rubble(seed):
    """Flat stones of random heights in random places, and holes in the map."""
    rng = np.random.default_rng(seed)
    ground = Ground(lambda x, y: rng.normal(0.0, 0.002, x.shape), half=45)
    for _ in range(rng.integers(5, 80)):
        x, y = rng.uniform(-0.6, 0.6, 2)
        dx, dy = rng.uniform(0.03, 0.15, 2)
        stone = (np.abs(ground.x - x) < dx) & (np.abs(ground.y - y) < dy)
        ground.height[stone] = np.nan if rng.random() < 0.2 else rng.uniform(-0.1, 0.1)
    for _ in range(4):
        ground.collapsed[ground.cell(*rng.uniform(-0.5, 0.5, 2))] = 30.0
    return ground


def asked_at_random(seed):
    rng = np.random.default_rng([seed, 1])
    return standing_at(0.24 + rng.uniform(-0.1, 0.1), 0.14 + rng.uniform(-0.1, 0.1))


@pytest.fixture(scope="module")
def answers():
    return [(asked_at_random(seed), rubble(seed)) for seed in range(200)]


def test_footholds_and_regions_on_rubble(answers):
    stayed = moved = none = blind = alone = 0
    for asked, ground in answers:
        answer = ground.ask(**asked)
        for leg, target in enumerate(asked["targets"]):
            foothold, safe = answer.foothold_WF[leg], answer.heightmap_unsafe[leg] == 0
            if not answer.region_active[leg]:
                np.testing.assert_array_equal(foothold, target)
                unknown = np.isnan(answer.heightmap_m[leg]).mean()
                none += not answer.safe[leg]
                blind += answer.safe[leg]
                assert unknown > 0.5 if answer.safe[leg] else not safe.any()
                continue
            assert answer.safe[leg]
            low, high = boxes(answer, leg)
            margin = answer.region_a[leg] @ foothold + answer.region_b[leg]
            assert margin.min() >= -1e-9
            inside = ((centres(answer, leg) > low) & (centres(answer, leg) < high)).all(axis=-1)
            assert safe[inside].all() and inside.sum() >= 1
            # It ends where cells end: it holds whole cells, of the heightmap.
            assert inside.sum() * CELL**2 == pytest.approx(np.prod(high - low))
            alone += inside.sum() == 1
            if safe[7, 7]:
                stayed += 1
                np.testing.assert_array_equal(foothold[:2], target[:2])
            else:
                moved += 1
                np.testing.assert_allclose(foothold[:2], nearest(answer, leg, target), atol=1e-12)
    assert min(stayed, moved, none, alone) >= 10, (stayed, moved, none, blind, alone)


def test_a_foot_anywhere_in_a_region_stands_on_no_edge(answers):
    """The region is not shrunk by the foot: its border is as safe as its middle."""
    rng, points = np.random.default_rng(5), 0
    for asked, ground in answers[::5]:
        answer = ground.ask(**asked)
        for leg in np.flatnonzero(answer.region_active):
            low, high = boxes(answer, leg)
            corners = np.array([low, high, [low[0], high[1]], [high[0], low[1]]])
            corners += 1e-6 * np.sign((low + high) / 2 - corners)
            for p in np.concatenate([corners, rng.uniform(low, high, (4, 2))]):
                dx = np.maximum(np.abs(ground.x - p[0]) - CELL / 2, 0.0)
                dy = np.maximum(np.abs(ground.y - p[1]) - CELL / 2, 0.0)
                under = np.where(np.hypot(dx, dy) < RADIUS, ground.height, np.nan)
                for axis in (0, 1):
                    assert not (np.abs(np.diff(under, axis=axis)) > 0.03).any()
                points += 1
    assert points > 200


def test_the_same_question_has_the_same_answer_to_the_last_bit(answers):
    for asked, ground in answers[:20]:
        once = encode(ground.ask(**asked))
        fresh = FootholdAdaptation(ROBOT, ElevationMap(), Fsm())
        assert encode(ground.ask(**asked)) == once == encode(ground.ask(adaptation=fresh, **asked))


def test_of_equally_near_cells_the_first_along_x_and_y():
    ground = Ground()
    ground.collapsed[ground.cell(0.2, 0.2)] = 30.0  # the square of 5x5 cells around the target is lost
    np.testing.assert_allclose(ground.ask(**AT).foothold_WF[0, :2], [0.14, 0.2], atol=1e-9)
    ground.collapsed[ground.cell(0.14, 0.2)] = 30.0  # cells 2 to 9 along x
    np.testing.assert_allclose(ground.ask(**AT).foothold_WF[0, :2], [0.2, 0.14], atol=1e-9)


def test_no_rounding_chooses_between_equally_near_cells():
    for k in range(-12, 13):
        x, y = CELL * k, CELL * (k + 3)
        ground = Ground()
        ground.collapsed[ground.cell(x, y)] = 30.0
        np.testing.assert_allclose(ground.ask(**standing_at(x, y)).foothold_WF[0, :2], [x - 0.06, y], atol=1e-9)


def test_a_safe_target_is_kept_between_the_cells_centres():
    asked = standing_at(0.2077, 0.1934)
    answer = Ground(lambda x, y: 0.1 * x).ask(**asked)
    np.testing.assert_array_equal(answer.foothold_WF[:, :2], asked["targets"][:, :2])
    expected = 0.1 * asked["targets"][:, 0] + RADIUS * np.hypot(1.0, 0.1)
    np.testing.assert_allclose(answer.foothold_WF[:, 2], expected, atol=1e-12)


def test_a_foothold_beside_a_step_moves_off_it_and_says_why():
    ground = Ground(lambda x, y: np.where(x > 0.21, -0.2, 0.0))
    answer = ground.ask(**AT)
    # Cells 6 and 7 reach over the border between 7 and 8.
    np.testing.assert_allclose(answer.foothold_WF[0], [0.16, 0.2, RADIUS], atol=1e-9)
    assert answer.reasons[0].startswith("moved 4.0 cm: the target's cell is ")
    assert "edge" in answer.reasons[0] and "unknown" not in answer.reasons[0]
    assert boxes(answer, 0)[1][0] == pytest.approx(0.17)


@pytest.mark.parametrize("yaw", [0.25 * np.pi, 0.5 * np.pi, np.pi, -2.0])
@pytest.mark.parametrize("way", [(1.0, 0.0), (-1.0, 0.0), (0.0, 1.0)], ids=("forward", "backward", "left"))
def test_a_robot_that_is_turned_finds_the_same_ground_safe(yaw, way):
    """The map's axes are the world's: a leg's reach and its way over the ground are not."""
    R_WB = matrix_of_rpy(np.array([0.0, 0.0, yaw]))
    height = RADIUS - NOMINAL_BF[0, 2]
    feet = NOMINAL_BF @ R_WB.T + [0.0, 0.0, height]
    step = R_WB @ np.append(0.1 * np.array(way), 0.0)
    asked = {"targets": feet + step, "feet": feet, "base": np.append(step + [0.0, 0.0, height], [0.0, 0.0, yaw])}
    level = Ground().ask(**asked)
    assert not level.heightmap_unsafe.any()
    np.testing.assert_allclose(level.foothold_WF, asked["targets"], atol=1e-12)
    # A wall half way of every step, as high as a calf, is met by every leg, whatever the direction.
    unit = step / 0.1
    for leg in range(4):
        middle = (feet[leg] + 0.5 * step)[:2]
        wall = Ground(
            lambda x, y, p=middle: np.where(np.abs((x - p[0]) * unit[0] + (y - p[1]) * unit[1]) < 0.02, 0.2, 0.0)
        )
        assert flagged(wall.ask(**asked), Unsafe.LEG, leg)[7, 7]


def test_without_a_safe_cell_it_says_what_is_wrong():
    ground = Ground()
    ground.std[:] = 0.1
    ground.collapsed[ground.cell(0.2, 0.2)] = 30.0
    answer = ground.ask(**AT)
    assert not answer.safe[0] and not answer.region_active[0]
    np.testing.assert_array_equal(answer.foothold_WF, AT["targets"])
    assert answer.reasons[0] == "no safe cell of 225: 225 uncertain, 25 collapsed"


def test_without_a_map_the_whole_plane_is_allowed():
    for ground in (Ground(lambda x, y: np.full(x.shape, np.nan)), Ground(half=1)):
        answer = ground.ask(**AT)
        assert answer.safe.all() and not answer.region_active.any() and not answer.held_n.any()
        np.testing.assert_array_equal(answer.foothold_WF, AT["targets"])
        assert answer.reasons[0].startswith("no map there: 2")
    far = dict(AT, targets=AT["targets"] + [50.0, -80.0, 0.0])
    answer = Ground().ask(**far)
    np.testing.assert_array_equal(answer.foothold_WF, far["targets"])
    assert answer.reasons[0] == "no map there: 225 of 225 cells unknown"


@pytest.mark.parametrize(("columns", "active"), [(7, True), (8, False)])
def test_what_was_seen_too_long_ago_is_no_map(columns, active):
    """A robot that has rested for long must be able to go on: its hind feet's ground is not seen again."""
    ground = Ground()
    ground.age[ground.x > 0.2 + CELL * (7.5 - columns)] = 1e4
    ground.height[ground.cell(0.06, 0.06)] = np.nan  # the heightmap's first cell
    answer = ground.ask(**AT)
    assert answer.safe[0] and answer.region_active[0] == active
    if not active:
        np.testing.assert_array_equal(answer.foothold_WF[0], AT["targets"][0])
        assert answer.reasons[0] == "no map there: 1 of 225 cells unknown, 120 seen more than 600 s ago"


@pytest.mark.parametrize(("columns", "active"), [(7, True), (8, False)])
def test_half_a_map_is_a_map_and_less_is_none(columns, active):
    ground = Ground(lambda x, y: np.where(x > 0.2 + CELL * (7.5 - columns), np.nan, 0.0))
    answer = ground.ask(**AT)
    assert np.isnan(answer.heightmap_m[0]).sum() == 15 * columns
    assert answer.region_active[0] == active and answer.safe[0]


def test_the_map_may_be_there_for_one_leg_only():
    ground = Ground(lambda x, y: np.where(x < 0.0, np.nan, 0.0))
    answer = ground.ask(**AT)
    np.testing.assert_array_equal(answer.region_active, [True, True, False, False])


def test_a_foothold_is_certified_for_the_least_that_was_borne_under_the_whole_foot():
    ground = Ground()
    near = np.hypot(ground.x - 0.2, ground.y - 0.2)
    ground.held[near < RADIUS] = 90.0
    ground.held[ground.cell(0.22, 0.2)] = 70.0
    assert ground.ask(**AT).held_n.tolist() == [70.0, 0.0, 0.0, 0.0]
    # A centimetre beside what was probed the foot covers ground that was not.
    assert ground.ask(**standing_at(0.209, 0.2)).held_n[0] == 0.0
    ground.held[near < 2.0 * RADIUS] = 80.0
    assert ground.ask(**standing_at(0.209, 0.2)).held_n[0] == 80.0


def test_the_heightmap_lies_on_the_maps_cells_around_the_target():
    ground = Ground(lambda x, y: 0.03 * np.sin(9.0 * x) + 0.02 * y)
    asked = standing_at(0.2077, 0.1934)
    answer = ground.ask(**asked)
    assert answer.id == 7 and answer.t == 3.0 and answer.valid and answer.cell_m == CELL
    for leg, target in enumerate(asked["targets"]):
        assert np.abs(centres(answer, leg)[7, 7] - target[:2]).max() <= CELL / 2 + 1e-9
        i, j = ground.cell(*centres(answer, leg)[0, 0])
        np.testing.assert_allclose(centres(answer, leg)[0, 0], [ground.x[i, j], ground.y[i, j]], atol=1e-9)
        np.testing.assert_allclose(answer.heightmap_m[leg], ground.height[i : i + 15, j : j + 15], atol=1e-7)


def test_the_answer_goes_over_the_wire():
    ground = rubble(1)
    answer = ground.ask(**asked_at_random(1))
    back = decode(FootholdRegions, encode(answer))
    for field in dataclasses.fields(FootholdRegions):
        np.testing.assert_array_equal(getattr(back, field.name), getattr(answer, field.name))


def test_thresholds_are_the_settings():
    step = Ground(lambda x, y: np.where(x > 0.25, 0.04, 0.0))
    assert step.ask(**AT).heightmap_unsafe[0].any()
    patient = Vfa(edge_max_m=0.05, slope_max=0.9, plane_error_max_m=0.05, clearance_m=0.0)
    adaptation = FootholdAdaptation(ROBOT, ElevationMap(vfa=patient), Fsm())
    assert not step.ask(adaptation=adaptation, **AT).heightmap_unsafe[0].any()


def sizes_asked(asked):
    """(4, 2) half sizes in cells of the patches that a request asks for."""
    sizes, ground = [], Ground()
    whole = ground.cut

    def cut(p_xy, half_x, half_y):
        sizes.append((half_x, half_y))
        return whole(p_xy, half_x, half_y)

    ground.cut = cut
    ground.ask(**asked)
    return np.array(sizes)


def test_the_patch_holds_the_way_of_the_foot_and_the_leg_above_every_cell():
    near, far = sizes_asked(standing_at(0.2, 0.2, step=0.02)), sizes_asked(standing_at(0.2, 0.2, step=0.5))
    around = 7 + 3  # the heightmap, and what a foot touches with its clearance
    assert near.shape == (4, 2) and near.min() >= around + 0.25 / CELL
    assert far[:, 0].min() >= around + 0.5 / CELL
    np.testing.assert_array_equal(far[:, 1], near[:, 1])


def test_the_patch_is_bounded_wherever_the_feet_are_said_to_be():
    asked = standing_at(0.2, 0.2)
    asked["feet"] = asked["feet"] + [1e6, -1e6, 0.0]
    assert sizes_asked(asked).max() < 80
