"""The depth camera measures what is there, bridges slits and masks the robot."""

import dataclasses

import mujoco
import numpy as np
import pytest

from surefoot.components.robot_model.rotation import matrix_of, matrix_of_rpy, quaternion_of
from surefoot.config.deployment import Deployment, Run
from surefoot.config.depth_camera import DepthCamera as Settings
from surefoot.config.hw import Hw
from surefoot.config.terrain import Planks, Terrain
from surefoot.hw.mujoco.backend import MujocoRobot
from surefoot.hw.mujoco.depth_camera import DepthCamera

CLEAN = Settings(noise_m=0.0, dropout=0.0)
PLANKS = Planks()


def robot(kind="flat", depth=CLEAN, vision=True, **settings):
    return MujocoRobot(
        Deployment(run=Run(vision=vision), hw=Hw(depth=depth, **settings), terrain=Terrain(kind=kind))
    )


def points_W(image, data):
    """(rows, columns, 3) where the message's convention puts the pixels; NaN where there is no depth."""
    rows, columns = image.depth_m.shape
    y = np.tan(0.5 * image.fov[0]) * (1.0 - (2.0 * np.arange(columns) + 1.0) / columns)
    z = np.tan(0.5 * image.fov[1]) * (1.0 - (2.0 * np.arange(rows) + 1.0) / rows)
    rays_C = np.stack(np.broadcast_arrays(1.0, y[None, :], z[:, None]), axis=2)
    p_C = rays_C * np.where(image.depth_m > 0.0, image.depth_m, np.nan)[..., None]
    R_WB = matrix_of(data.qpos[3:7])
    return data.qpos[:3] + (image.p_BC + p_C @ matrix_of(image.quat_BC).T) @ R_WB.T


def put(machine, x, y, z, rpy):
    """The trunk somewhere, legs as they are, boards level."""
    machine.data.qpos[:3], machine.data.qpos[3:7] = (x, y, z), quaternion_of(matrix_of_rpy(np.array(rpy)))
    machine.data.qpos[19:] = 0.0
    mujoco.mj_kinematics(machine.model, machine.data)


def test_on_flat_ground_every_pixel_lies_on_it():
    machine = robot()
    points = points_W(machine.depth(), machine.data)
    seen = np.isfinite(points[..., 2])
    assert seen.mean() > 0.9
    np.testing.assert_allclose(points[seen][:, 2], 0.0, atol=1e-5)


def test_it_sees_the_next_footholds_and_beyond():
    machine = robot()
    middle = points_W(machine.depth(), machine.data)[:, 40]
    assert np.nanmin(middle[:, 0]) < 0.36 and 1.2 < np.nanmax(middle[:, 0]) < 1.5


def crossing_W(points, data):
    """(rows, columns, 2) where the lines from the camera to points cross the surface z = 0."""
    p_WC = data.qpos[:3] + matrix_of(data.qpos[3:7]) @ CLEAN.p_B
    share = p_WC[2] / (p_WC[2] - np.minimum(points[..., 2], 0.0))
    return p_WC[:2] + share[..., None] * (points[..., :2] - p_WC[:2])


@pytest.mark.parametrize("seed", range(2))
def test_gaps_between_planks_are_never_seen_from_any_pose_of_a_walking_robot(seed):
    machine = robot("planks")
    camera, single = (
        DepthCamera(dataclasses.replace(CLEAN, slit_m=slit), machine.model, 0) for slit in (CLEAN.slit_m, 0.0)
    )
    rng = np.random.default_rng(seed)
    field, width, through = machine.field, PLANKS.columns * (PLANKS.board_width_m + PLANKS.gap_m), 0
    for _ in range(150):
        x, y = rng.uniform(field.start_x - 0.5, field.end_x - 0.3), rng.uniform(-0.2, 0.2)
        roll, pitch = rng.uniform(-0.15, 0.15, 2)
        put(machine, x, y, rng.uniform(0.25, 0.45), (roll, pitch, rng.uniform(-3.1, 3.1)))
        below = []
        for each in (camera, single):
            points = points_W(each.image(machine.data), machine.data)
            at = crossing_W(points, machine.data)
            # But for a pixel's breadth at the field's sides, where a slit ends in the open.
            on = (at[..., 0] > field.start_x) & (at[..., 0] < field.end_x)
            on &= np.abs(at[..., 1]) < 0.5 * width - 0.03
            below.append(points[on & (points[..., 2] < -0.003)])
        assert not len(below[0]), f"{below[0][:4]} from {machine.data.qpos[:7]}"
        through += len(below[1])
    assert through > 2000  # single rays do fall through: it is the windows that bridge


@pytest.mark.parametrize("height", [0.25, 0.38, 0.45])
def test_a_missing_board_is_seen_as_a_hole_as_deep_as_the_frame(height):
    machine = robot("planks")
    geom = machine.model.body_geomadr[machine.model.body("board_1_1").id]
    centre = machine.data.geom_xpos[geom].copy()
    machine.model.geom_pos[geom] += [0.0, 0.0, -50.0]
    put(machine, centre[0] - CLEAN.p_B[0] - 0.6 * height, centre[1] + 0.05, height, (0.05, -0.05, 0.1))
    points = points_W(DepthCamera(CLEAN, machine.model, 0).image(machine.data), machine.data)
    inside = np.abs(crossing_W(points, machine.data) - centre[:2]).max(axis=2) < 0.08
    assert inside.sum() > 50
    floor = points[..., 2] < -PLANKS.frame_height_m + 1e-4
    assert (inside & floor).sum() > 0.5 * inside.sum()
    # What is not floor is a wall of the hole, met below its rim.
    assert points[inside][:, 2].max() < -0.01


def test_the_robots_own_legs_are_masked():
    machine = robot()
    q = machine.data.qpos
    q[7:10] = [0.0, 0.0, -0.9]  # the left front leg reaches far forward, into the picture
    mujoco.mj_kinematics(machine.model, machine.data)
    camera = machine._camera
    _, own, _ = camera._cast(machine.data)
    pad = camera._pad
    leg = own[pad:-pad, pad:-pad]
    assert leg.sum() > 30
    image = camera.image(machine.data)
    assert (image.depth_m[leg] == 0.0).all()
    points = points_W(image, machine.data)
    assert np.nanmax(points[..., 2]) < 1e-4 and np.isfinite(points[..., 2]).sum() > 2000


def test_noise_grows_with_the_square_of_the_depth_and_dropouts_have_their_share():
    noisy, clean = Settings(noise_m=0.004, dropout=0.1), CLEAN
    machine = robot(depth=noisy)
    truth = DepthCamera(clean, machine.model, 0).image(machine.data).depth_m
    images = np.stack([machine._camera.image(machine.data).depth_m for _ in range(60)])
    usual = truth > 0.0
    assert (images[:, usual] == 0.0).mean() == pytest.approx(0.1, abs=0.01)
    error = np.where(images > 0.0, images - truth, np.nan)[:, usual] / truth[usual] ** 2
    assert np.nanstd(error) == pytest.approx(0.004, rel=0.03) and abs(np.nanmean(error)) < 2e-4
    near, far = truth[usual] < 0.45, truth[usual] > 0.8
    assert np.nanstd(error[:, near]) == pytest.approx(np.nanstd(error[:, far]), rel=0.1)


def test_out_of_range_there_is_no_depth():
    machine = robot(depth=dataclasses.replace(CLEAN, range_min_m=0.5, range_max_m=0.7))
    depth = machine.depth().depth_m
    seen = depth > 0.0
    assert seen.any() and not seen.all() and depth[seen].min() >= 0.5 and depth[seen].max() <= 0.7


@pytest.mark.parametrize(
    ("settings", "height", "roll"),
    [
        (Settings(), 0.4, np.pi),  # on its back it looks into the sky
        (Settings(), 60.0, 0.0),  # the ground is out of range
        (Settings(p_B=(0.0, 0.0, 0.0)), 0.4, 0.0),  # inside the trunk
    ],
)
@pytest.mark.filterwarnings("error")
def test_where_there_is_nothing_to_see_no_pixel_has_a_depth(settings, height, roll):
    machine = robot(depth=settings)
    put(machine, 0.0, 0.0, height, (roll, 0.0, 0.0))
    depth = machine.depth().depth_m
    assert depth.shape == (60, 80) and (depth == 0.0).all()


def test_on_its_side_it_measures_what_it_sees():
    machine = robot()
    put(machine, 0.0, 0.0, 0.4, (0.5 * np.pi, 0.0, 0.0))
    points = points_W(machine.depth(), machine.data)
    seen = np.isfinite(points[..., 2])
    assert 0.2 < seen.mean() < 0.6
    np.testing.assert_allclose(points[seen][:, 2], 0.0, atol=1e-4)


def test_images_come_at_their_rate_and_never_blind():
    machine, blind = robot(depth=Settings(rate_hz=15.0)), robot(vision=False)
    due = []
    for cycle in range(500):
        if machine.depth() is not None:
            due.append(2 * cycle)
        assert blind.depth() is None
        machine.advance()
    assert due == [2 * int(np.ceil(index * 1000.0 / 30.0)) for index in range(15)]


def test_a_seed_gives_the_same_images_and_another_gives_others():
    first, again, other = (robot(depth=Settings(), seed=seed).depth().depth_m for seed in (1, 1, 2))
    np.testing.assert_array_equal(first, again)
    assert (first != other).any()


def test_seeing_changes_no_other_sensor():
    seeing, blind = robot(depth=Settings()), robot(vision=False)
    for _ in range(40):
        seeing.depth()
        mine, other = seeing.read(), blind.read()
        for name in ("q", "dq", "tau", "omega_WB_B", "acc_B"):
            np.testing.assert_array_equal(getattr(mine, name), getattr(other, name))
        seeing.advance()
        blind.advance()
