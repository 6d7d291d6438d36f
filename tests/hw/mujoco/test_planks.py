"""The planks are the levers that the press test and the closed form say they are."""

import dataclasses

import pytest

from surefoot.config.deployment import Deployment
from surefoot.config.terrain import Planks, Terrain
from surefoot.hw.mujoco.press_test import PressTest

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
