"""The inclined planks lie on one straight incline, and are levers as the level ones are."""

from math import cos, radians, sin, tan

import mujoco
import numpy as np
import pytest

from surefoot.config.deployment import Deployment
from surefoot.config.hw import Hw
from surefoot.config.terrain import Planks, Slope, Terrain
from surefoot.hw.mujoco.press_test import PressTest
from surefoot.hw.mujoco.scene import build_scene

PLANKS = Planks()
BOARD_Y = 0.5 * (PLANKS.gap_m + PLANKS.board_width_m)


def deployment(low=8.0, high=8.0, seed=0):
    slope = Slope(angle_min_deg=low, angle_max_deg=high)
    return Deployment(terrain=Terrain(kind="slope", slope=slope), hw=Hw(seed=seed))


def scene(deployment):
    model, field = build_scene(deployment, None, 0.6)
    data = mujoco.MjData(model)
    mujoco.mj_kinematics(model, data)
    return model, data, field


@pytest.mark.parametrize("angle_deg", [8.0, -8.0])
def test_every_board_lies_on_the_incline(angle_deg):
    _, data, field = scene(deployment(angle_deg, angle_deg))
    angle = radians(angle_deg)
    for row in range(PLANKS.rows):
        along = row * PLANKS.pitch_m + PLANKS.beam_width_m
        for column in range(PLANKS.columns):
            hinge, R = data.body(f"board_{row}_{column}").xpos, data.body(f"board_{row}_{column}").xmat
            assert hinge[0] == pytest.approx(field.start_x + along * cos(angle))
            assert hinge[2] == pytest.approx(along * sin(angle))
            np.testing.assert_allclose(R.reshape(3, 3)[:, 0], [cos(angle), 0.0, sin(angle)], atol=1e-12)


@pytest.mark.parametrize("angle_deg", [8.0, -8.0])
def test_the_surface_is_where_the_field_says(angle_deg):
    press = PressTest(deployment(angle_deg, angle_deg))
    _, _, field = scene(deployment(angle_deg, angle_deg))
    rise = PLANKS.rows * PLANKS.pitch_m * sin(radians(angle_deg))
    assert field.level(field.start_x - 0.5) == 0.0
    assert field.level(field.end_x + 0.5) == pytest.approx(rise)
    assert field.level(field.start_x + 0.3) == pytest.approx(0.3 * tan(radians(angle_deg)))
    for x in (
        field.start_x - 0.5,
        field.start_x + 0.02,
        field.start_x + 0.15,
        field.end_x - 0.1,
        field.end_x + 0.5,
    ):
        assert press.surface(x, BOARD_Y) == pytest.approx(field.level(x), abs=1e-9)


def test_the_ground_beneath_leaves_room_to_fall_everywhere():
    for angle_deg in (8.0, -8.0):
        _, data, field = scene(deployment(angle_deg, angle_deg))
        ground = data.geom("ground").xpos[2]
        lowest = min(field.level(field.start_x), field.level(field.end_x))
        assert lowest - ground == pytest.approx(PLANKS.frame_height_m)


@pytest.mark.parametrize("angle_deg", [8.0, -8.0])
def test_an_inclined_board_sinks_like_a_lever(angle_deg):
    # A weight F at d along the board turns it by (F d cos a + ...) / (k L^2), and goes down by that times d cos a.
    press, (_, _, field) = PressTest(deployment(angle_deg, angle_deg)), scene(deployment(angle_deg, angle_deg))
    force, d, slant = 60.0, 0.07, cos(radians(angle_deg))
    k_hinge = PLANKS.stiffness * PLANKS.board_length_m**2
    moment = (force * d + PLANKS.board_mass * 9.81 * 0.5 * PLANKS.board_length_m) * slant
    moment -= PLANKS.preload_n * PLANKS.board_length_m
    sunk = press.press(field.start_x + (PLANKS.beam_width_m + d) * slant, BOARD_Y, force).displacement_m
    assert sunk == pytest.approx(d * slant * moment / k_hinge, rel=0.25)
    end = field.start_x + (PLANKS.beam_width_m + 0.18) * slant
    assert press.press(end, BOARD_Y, force).collapsible
    assert not press.press(field.start_x + 0.02, BOARD_Y, 150.0).collapsible


def test_the_angle_is_drawn_between_its_limits_from_the_seed():
    def angle(seed):
        _, _, field = scene(deployment(5.0, 10.0, seed))
        (x0, z0), (x1, z1) = field.profile
        return np.degrees(np.arctan2(z1 - z0, x1 - x0))

    angles = [angle(seed) for seed in range(8)]
    assert 5.0 <= min(angles) < max(angles) <= 10.0 and max(angles) - min(angles) > 1.0
    assert angle(3) == angles[3] and len(set(angles)) == 8
