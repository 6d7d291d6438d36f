"""The planks are the levers that the press test and the closed form say they are."""

import dataclasses

import mujoco
import pytest

from surefoot.config.deployment import Deployment
from surefoot.config.hw import Hw
from surefoot.config.terrain import Planks, Terrain
from surefoot.hw.mujoco.press_test import PressTest
from surefoot.hw.mujoco.scene import build_scene

PLANKS = Planks()
BOARD_Y = 0.5 * PLANKS.gap_m + 0.5 * PLANKS.board_width_m  # middle of a board beside the centre line


def deployment(**settings):
    return Deployment(terrain=Terrain(kind="planks", planks=dataclasses.replace(PLANKS, **settings)))


@pytest.fixture(scope="module")
def press():
    return PressTest(deployment())


def x_of(distance_from_hinge):
    robot = Deployment().load_robot()
    front_x = robot.legs["FL"].hip_p_B[0] + robot.foot.radius
    return front_x + PLANKS.start_offset_m + PLANKS.beam_width_m + distance_from_hinge


def test_the_beam_bears(press):
    assert press.press(x_of(-0.02), BOARD_Y, 150.0).displacement_m < 2e-3


def test_the_free_end_gives_way(press):
    result = press.press(x_of(0.16), BOARD_Y, 60.0)
    assert result.collapsible and result.displacement_m > 0.06


def test_near_the_beam_a_board_sinks_like_a_lever(press):
    # Static lever: F d^2 / (k L^2), less what the preload holds and the board's weight adds.
    force, d = 60.0, 0.06
    k_hinge = PLANKS.stiffness * PLANKS.board_length_m**2
    moment = force * d - PLANKS.preload_n * PLANKS.board_length_m
    moment += PLANKS.board_mass * 9.81 * 0.5 * PLANKS.board_length_m
    assert press.press(x_of(d), BOARD_Y, force).displacement_m == pytest.approx(d * moment / k_hinge, rel=0.25)


def test_a_stiffer_spring_holds_what_a_soft_one_does_not():
    soft, stiff = PressTest(deployment(stiffness=300.0)), PressTest(deployment(stiffness=3000.0))
    where = x_of(0.12)
    assert soft.press(where, BOARD_Y, 80.0).collapsible
    assert not stiff.press(where, BOARD_Y, 80.0).collapsible


def test_flat_ground_never_collapses():
    flat = PressTest(Deployment())
    assert flat.press(0.3, 0.1, 150.0).displacement_m < 2e-3


def test_beams_along_travel_turn_the_boards_sideways():
    along = PressTest(deployment(beam_direction="along"))
    robot = Deployment().load_robot()
    start_x = robot.legs["FL"].hip_p_B[0] + robot.foot.radius + PLANKS.start_offset_m
    width = PLANKS.rows * PLANKS.pitch_m
    beam_y = -0.5 * width + 0.5 * PLANKS.beam_width_m
    x = start_x + 0.5 * PLANKS.board_width_m
    assert not along.press(x, beam_y, 110.0).collapsible
    assert along.press(x, beam_y + 0.2, 60.0).collapsible


def boards(deployment):
    """Boards there are, by row and column."""
    model, _ = build_scene(deployment, None, 0.6)
    names = (model.body(index).name for index in range(model.nbody))
    return {tuple(map(int, name.split("_")[1:])) for name in names if name.startswith("board_")}


EVERY = {(row, column) for row in range(PLANKS.rows) for column in range(PLANKS.columns)}


def test_a_listed_board_is_a_hole_and_no_other_is():
    holes = {(1, 2), (3, 0)}
    with_holes = deployment(missing=tuple(holes))
    assert boards(with_holes) == EVERY - holes
    press = PressTest(with_holes)
    for row, column in EVERY:
        y = (column - 0.5 * PLANKS.columns) * (PLANKS.board_width_m + PLANKS.gap_m) + 0.5 * PLANKS.board_width_m
        depth = PLANKS.frame_height_m if (row, column) in holes else 0.0
        assert press.surface(x_of(row * PLANKS.pitch_m + 0.1), y) == pytest.approx(-depth, abs=1e-9)
        assert press.surface(x_of(row * PLANKS.pitch_m - 0.02), y) == pytest.approx(0.0, abs=1e-9)


@pytest.mark.parametrize("count", [2, 5])
def test_drawn_holes_leave_a_way_across(count):
    seen = set()
    for seed in range(40):
        drawn = dataclasses.replace(deployment(missing_count=count), hw=Hw(seed=seed))
        holes = EVERY - boards(drawn)
        assert len(holes) == count
        assert not any((row + 1, column) in holes for row, column in holes)
        for row in range(PLANKS.rows):
            assert sum(hole[0] == row for hole in holes) <= PLANKS.columns // 2
        seen.add(frozenset(holes))
    assert boards(drawn) == EVERY - holes, "the same seed, the same holes"
    assert len(seen) > 30
    assert set().union(*seen) == EVERY, "any board can be missing"


def test_as_many_holes_as_the_settings_allow_can_be_drawn():
    for rows, columns in ((1, 2), (2, 2), (8, 2), (3, 3), (16, 3), (4, 5)):
        most = min(16, rows * columns // 3)
        there = boards(deployment(rows=rows, columns=columns, missing_count=most))
        assert len(there) == rows * columns - most


def test_both_scenes_of_a_run_have_the_same_holes():
    drawn = deployment(missing_count=4)
    robots, _ = build_scene(drawn, drawn.load_robot(), 0.6)
    for row, column in EVERY:
        there = (row, column) in boards(drawn)
        assert (mujoco.mj_name2id(robots, mujoco.mjtObj.mjOBJ_BODY, f"board_{row}_{column}") >= 0) == there
