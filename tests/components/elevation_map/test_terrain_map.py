"""The map against the ground it was made from: scenes of boxes seen by a noisy camera on the way."""

import dataclasses

import numpy as np
import pytest
from sight import UP, Sight, box, deployment, estimate

from surefoot.bus.messages import FsmEvent, LegStatus, MotionReference
from surefoot.components.elevation_map.terrain_map import TerrainMap
from surefoot.config.depth_camera import DepthCamera
from surefoot.config.elevation_map import ElevationMap

HEIGHT = 0.394
NOISY = DepthCamera(noise_m=0.003, dropout=0.05)
RADIUS = deployment().load_robot().foot.radius
STANCE = np.array([[0.24, 0.13, RADIUS], [0.24, -0.13, RADIUS], [-0.24, 0.13, RADIUS], [-0.24, -0.13, RADIUS]])


def fresh_map(**settings):
    return TerrainMap(dataclasses.replace(ElevationMap(), **settings), RADIUS)


def walk(sight, seeing, poses, t0=0.0, error=lambda t: (np.zeros(3), np.zeros(3)), **given):
    """Sees the scene from poses (p_WB, rpy) one after another; returns the time of the last image.

    `error` of a time is what the estimate of it is wrong by: position and roll, pitch, yaw.
    """
    t = t0
    for index, (p_WB, rpy) in enumerate(poses):
        t = t0 + index / 15.0
        off_p, off_rpy = error(t)
        seen_from = estimate(t, np.array(p_WB) + off_p, np.array(rpy) + off_rpy, **given)
        seeing.follow(seen_from.p_WB)
        seeing.see(sight.frame(t, p_WB, rpy), seen_from, None)
    return t


def strolling(count, x0=0.0, speed=0.1):
    """Poses of a trunk that goes forward and sways."""
    return [
        (
            (x0 + speed * i / 15.0, 0.02 * np.sin(0.3 * i), HEIGHT + 0.01 * np.sin(0.21 * i)),
            (0.04 * np.sin(0.17 * i), 0.03 * np.cos(0.13 * i), 0.1 * np.sin(0.05 * i)),
        )
        for i in range(count)
    ]


def known(seeing, t):
    """x, y (k, 2), heights and standard deviations of the known cells, float64."""
    grid = seeing.message(t)
    index = np.argwhere(np.isfinite(grid.height_m))
    at = grid.p_W + index * grid.cell_m
    where = tuple(index.T)
    return at, grid.height_m[where].astype(float), grid.std_m[where].astype(float)


STEPS = (
    box("low", (1.0, 0.0, 0.04), (0.2, 0.8, 0.04)),  # 0.08 m high from x = 0.8 to 1.2
    box("high", (1.5, 0.0, 0.08), (0.3, 0.8, 0.08)),  # 0.16 m high from x = 1.2 on
    box("post", (0.75, 0.25, 0.06), (0.05, 0.05, 0.06)),
)


def steps_z(at):
    x, y = at.T
    z = np.where(x > 1.2, 0.16, np.where(x > 0.8, 0.08, 0.0))
    return np.where((np.abs(x - 0.75) < 0.05) & (np.abs(y - 0.25) < 0.05), 0.12, z)


def test_steps_to_a_centimetre_while_the_camera_moves():
    seeing = fresh_map()
    t = walk(Sight(*STEPS, depth=NOISY), seeing, strolling(90), tilt_std=0.003)
    at, z, std = known(seeing, t)
    # A cell that a vertical face stands in, or reaches within a cell of, has two heights: it must show one of
    # what is there, and nothing above.
    around = np.stack([steps_z(at + [dx, dy]) for dx in (-0.02, 0.0, 0.02) for dy in (-0.02, 0.0, 0.02)])
    face = np.ptp(around, axis=0) > 0.0
    error = z - steps_z(at)
    assert len(at) > 2500 and face.sum() > 50
    assert np.sqrt(np.mean(error[~face] ** 2)) < 0.004
    assert np.abs(error[~face]).max() < 0.02
    assert (z[face] < around.max(axis=0)[face] + 0.01).all()
    assert (z[face] > around.min(axis=0)[face] - 0.01).all()
    assert (std < 0.01).mean() > 0.95


@pytest.mark.parametrize("slope", [-0.35, 0.2, 0.5])
def test_a_slope_to_a_centimetre(slope):
    # A plate through x = 0.6, z = 0.02, that rises with x by the slope's angle; the floor is where it is above.
    c, s = np.cos(slope), np.sin(slope)
    plate = box("plate", np.array([0.6, 0.0, 0.02]) - 0.01 * np.array([-s, 0.0, c]), (0.5, 0.8, 0.01), -slope)
    sight = Sight(plate, depth=NOISY)
    seeing = fresh_map()
    t = walk(sight, seeing, strolling(45), tilt_std=0.003)
    at, z, _ = known(seeing, t)
    top = 0.02 + (at[:, 0] - 0.6) * np.tan(slope)
    on = (np.abs(at[:, 0] - 0.6) < 0.48 * c) & (top > 0.01) & (np.abs(at[:, 1]) < 0.75)
    assert on.sum() > 400
    error = (z - top)[on]
    assert np.sqrt(np.mean(error**2)) < 0.006
    assert np.abs(error).max() < 0.025


def test_what_the_map_says_of_its_own_errors_is_true():
    """An estimate whose tilt is off as much as it says makes errors as large as the map says."""
    off = []
    for seed in range(6):
        rng = np.random.default_rng(seed)
        tilt = np.append(rng.normal(scale=0.01, size=2), 0.0)
        seeing = fresh_map()
        t = walk(
            Sight(depth=NOISY, seed=seed),
            seeing,
            strolling(1),
            error=lambda t, tilt=tilt: (np.zeros(3), tilt),
            tilt_std=0.01,
        )
        _, z, std = known(seeing, t)
        off.append(z / std)
    rms = np.sqrt(np.mean(np.concatenate(off) ** 2))
    assert 0.3 < rms < 1.5


def test_the_robots_own_legs_leave_no_ghosts():
    sight, seeing = Sight(depth=NOISY), fresh_map()
    rng, hidden = np.random.default_rng(2), []
    for index in range(60):
        # Front legs wave through the picture.
        sight.data.qpos[7:13] = [0.0, rng.uniform(-0.5, 1.0), -1.0, 0.0, rng.uniform(-0.5, 1.0), -1.0]
        p_WB, t = (0.002 * index, 0.0, HEIGHT), index / 15.0
        frame = sight.frame(t, p_WB)
        hidden.append((frame.depth_m == 0.0).mean())
        seeing.see(frame, estimate(t, p_WB), None)
    assert max(hidden) > 2.0 * NOISY.dropout  # the legs were in the picture
    at, z, _ = known(seeing, t)
    assert len(at) > 1500 and z.max() < 0.012 and z.min() > -0.012


def test_gaps_between_planks_are_no_holes_and_a_missing_board_is_one():
    sight = Sight(kind="planks", depth=NOISY)
    geom = sight.model.body_geomadr[sight.model.body("board_1_1").id]
    centre, planks = np.array([0.7097, -0.105]), sight.deployment.terrain.planks
    sight.model.geom_pos[geom] += [0.0, 0.0, -50.0]
    seeing = fresh_map()
    t = walk(sight, seeing, strolling(90), tilt_std=0.002)
    at, z, _ = known(seeing, t)
    on = (at[:, 0] < sight.field.end_x) & (np.abs(at[:, 1]) < 0.37)
    hole = on & (np.abs(at - centre) < [0.07, 0.07]).all(axis=1)
    boards = on & ~(np.abs(at - centre) < [0.13, 0.13]).all(axis=1)
    assert hole.sum() > 20 and boards.sum() > 1000
    np.testing.assert_allclose(z[hole], -planks.frame_height_m, atol=0.02)
    np.testing.assert_allclose(z[boards], 0.0, atol=0.015)


def test_what_has_not_been_seen_stays_unknown():
    seeing = fresh_map()
    t = walk(Sight(depth=NOISY), seeing, [((0.0, 0.0, HEIGHT), (0.0, 0.0, 0.0))] * 5)
    behind = seeing.patch(np.array([-0.3, 0.0]), 7, 7, t)
    for layer in (behind.height_m, behind.std_m, behind.age_s):
        assert np.isnan(layer).all()
    assert (behind.held_n == 0.0).all() and (behind.collapsed_n == 0.0).all()
    ahead = seeing.patch(np.array([0.7, 0.0]), 7, 5, t + 2.0)
    assert ahead.height_m.shape == (15, 11) and np.isfinite(ahead.height_m).all()
    assert ahead.age_s.min() == pytest.approx(2.0) and ahead.age_s.max() < 2.3
    np.testing.assert_allclose(ahead.p_W, [0.57, -0.09], atol=1e-9)


def test_a_patch_off_the_map_is_unknown_and_at_its_rim_partly():
    seeing = fresh_map()
    t = walk(Sight(depth=NOISY), seeing, strolling(3))
    assert np.isnan(seeing.patch(np.array([40.0, -7.0]), 7, 7, t).height_m).all()
    rim = np.isnan(seeing.patch(np.array([1.2, 0.0]), 7, 7, t).height_m)
    assert rim[8:].all() and not rim[:6].all()


def test_one_wrong_frame_changes_nothing_and_a_lasting_change_is_taken_over():
    sight = Sight(box("rock", (0.8, 0.0, 0.1), (0.12, 0.12, 0.1)), depth=NOISY)
    rock = sight.model.geom("rock").id
    there = sight.model.geom_pos[rock].copy()
    away, seeing, pose = there - [0.0, 0.0, 5.0], fresh_map(), [((0.0, 0.0, HEIGHT), (0.0, 0.0, 0.0))]

    def middle(t):
        return seeing.patch(np.array([0.8, 0.0]), 1, 1, t).height_m

    t = 0.0
    for position, frames, height in (
        (away, 20, 0.0),
        (there, 1, 0.0),  # for one frame only
        (away, 2, 0.0),
        (there, 2, 0.0),
        (there, 1, 0.2),  # the third in a row
        (there, 10, 0.2),
        (away, 2, 0.2),
        (away, 6, 0.0),
    ):
        sight.model.geom_pos[rock] = position
        t = walk(sight, seeing, pose * frames, t0=t + 1.0 / 15.0)
        np.testing.assert_allclose(middle(t), height, atol=0.01, err_msg=f"after {frames} frames more")


def test_a_board_that_tilts_and_comes_back_is_followed():
    sight, seeing = Sight(kind="planks", depth=NOISY), fresh_map()
    joint = sight.model.joint("board_1_1").qposadr[0]
    swaying, t = [(np.add(p, [0.05, -0.1, 0.0]), rpy) for p, rpy in strolling(20, speed=0.0)], 0.0
    free_end = np.array([0.77, -0.105])  # 16 cm from the hinge
    for angle in (0.0, 0.4, 0.0):
        sight.data.qpos[joint] = angle
        t = walk(sight, seeing, swaying, t0=t + 1.0 / 15.0)
        patch = seeing.patch(free_end, 1, 3, t)
        np.testing.assert_allclose(np.nanmean(patch.height_m), -np.tan(angle) * 0.16, atol=0.015)


def test_ground_that_sinks_slowly_after_a_long_look_is_followed():
    sight = Sight(box("rock", (0.8, 0.0, 0.1), (0.12, 0.12, 0.1)), depth=NOISY)
    rock = sight.model.geom("rock").id
    seeing, pose = fresh_map(), [((0.0, 0.0, HEIGHT), (0.0, 0.0, 0.0))]
    t = walk(sight, seeing, pose * 300)
    for _ in range(150):  # 1 mm/s for 10 s
        sight.model.geom_pos[rock][2] -= 0.001 / 15.0
        t = walk(sight, seeing, pose, t0=t + 1.0 / 15.0)
    top = seeing.patch(np.array([0.8, 0.0]), 2, 2, t).height_m
    np.testing.assert_allclose(top, 0.19, atol=0.004)


def test_rays_that_pass_below_a_height_make_it_forgotten():
    sight, seeing = Sight(box("wall", (0.95, 0.0, 0.06), (0.03, 0.3, 0.06)), depth=NOISY), fresh_map()
    pose = [((0.0, 0.0, HEIGHT), (0.0, 0.0, 0.0))]
    t = walk(sight, seeing, pose * 10)
    assert np.nanmax(seeing.patch(np.array([0.95, 0.0]), 3, 10, t).height_m) > 0.11
    # The ground where the wall stood is not looked at any more, but the ground behind it is, through its place.
    sight.model.geom_pos[sight.model.geom("wall").id] -= [0.0, 0.0, 5.0]
    plain = sight.frame

    def cut_off(*given):
        frame = plain(*given)
        seen = frame.depth_m.copy()
        p_C = seen[..., None] * _rays(frame)
        x = given[1][0] + frame.p_BC[0] + np.cos(NOISY.pitch) * p_C[..., 0] + np.sin(NOISY.pitch) * p_C[..., 2]
        seen[np.abs(x - 0.95) < 0.035] = 0.0
        return dataclasses.replace(frame, depth_m=seen)

    sight.frame = cut_off
    t = walk(sight, seeing, pose * 6, t0=t + 1.0 / 15.0)
    heights = seeing.patch(np.array([0.95, 0.0]), 1, 10, t).height_m
    assert not (heights > 0.06).any()
    # And what the image still shows, or tells nothing of, has stayed.
    assert np.isfinite(seeing.patch(np.array([0.6, 0.0]), 3, 3, t).height_m).all()


def _rays(frame):
    rows, columns = frame.depth_m.shape
    y = np.tan(0.5 * frame.fov[0]) * (1.0 - (2.0 * np.arange(columns) + 1.0) / columns)
    z = np.tan(0.5 * frame.fov[1]) * (1.0 - (2.0 * np.arange(rows) + 1.0) / rows)
    return np.stack(np.broadcast_arrays(1.0, y[None, :], z[:, None]), axis=2)


def test_a_step_that_stands_is_not_seen_through():
    seeing = fresh_map()
    sight = Sight(*STEPS, depth=NOISY)
    t = walk(sight, seeing, strolling(60))
    before, _, _ = known(seeing, t)
    t = walk(sight, seeing, [strolling(61)[-1]] * 30, t0=t + 1.0 / 15.0)
    after, _, _ = known(seeing, t)
    assert len(after) > 0.995 * len(before)


def standing(p_WF, status=LegStatus.STANCE, contact=True):
    """Reference and figures of an estimate with all feet alike."""
    reference = MotionReference(t=0.0, valid=True, leg_status=np.full(4, status))
    return reference, {"p_WF": p_WF, "contact": np.full(4, contact), "normal_W": UP}


@pytest.mark.parametrize("drift", [0.03, -0.05])
def test_heights_move_to_where_the_feet_stand(drift):
    """The robot walked onto what it had seen while the height of its base drifted."""
    sight, seeing = Sight(depth=NOISY), fresh_map()
    t = walk(sight, seeing, strolling(60, x0=-1.0, speed=0.25))
    # Now it sees nothing new: the camera looks at ground above the map's rim only.
    feet = STANCE + [0.2, 0.0, drift]
    reference, figures = standing(feet)
    nothing = dataclasses.replace(sight.frame(t, (0.0, 0.0, HEIGHT)), depth_m=np.zeros((60, 80), np.float32))
    for _ in range(60):
        t += 1.0 / 15.0
        seeing.see(
            dataclasses.replace(nothing, t=t), estimate(t, (0.2, 0.0, HEIGHT + drift), **figures), reference
        )
    _, z, _ = known(seeing, t)
    assert np.median(z) == pytest.approx(drift, abs=2e-3)
    assert seeing.drift_m == pytest.approx(drift, abs=3e-3) and seeing.message(t).drift_m == seeing.drift_m


@pytest.mark.parametrize(
    ("status", "contact", "drift"),
    [
        (LegStatus.SWING, True, 0.03),
        (LegStatus.PROBING, True, 0.03),
        (LegStatus.COLLAPSING, True, 0.03),
        (LegStatus.STANCE, False, 0.03),
        (LegStatus.STANCE, True, 0.15),  # the foot stands on something else than was seen
    ],
)
def test_feet_that_are_not_trusted_move_nothing(status, contact, drift):
    sight, seeing = Sight(depth=NOISY), fresh_map()
    t = walk(sight, seeing, strolling(60, x0=-1.0, speed=0.25))
    reference, figures = standing(STANCE + [0.2, 0.0, drift], status, contact)
    seeing.see(sight.frame(t, (0.2, 0.0, HEIGHT)), estimate(t, (0.2, 0.0, HEIGHT), **figures), reference)
    assert seeing.drift_m == 0.0


@pytest.mark.parametrize("contacts", [[1, 1, 1, 1], [1, 1, 0, 0], [0, 1, 0, 0]])
def test_one_foot_on_a_board_that_sank_does_not_lower_the_map(contacts):
    sight, seeing = Sight(depth=NOISY), fresh_map()
    t = walk(sight, seeing, strolling(60, x0=-1.0, speed=0.25))
    feet = STANCE + [0.2, 0.0, 0.0]
    feet[1, 2] -= 0.04
    reference, figures = standing(feet)
    figures["contact"] = np.array(contacts, bool)
    for _ in range(30):
        t += 1.0 / 15.0
        seeing.see(sight.frame(t, (0.2, 0.0, HEIGHT)), estimate(t, (0.2, 0.0, HEIGHT), **figures), reference)
    assert abs(seeing.drift_m) < 2e-3


def event(kind, p_WF, **figures):
    return FsmEvent(t=1.0, valid=True, kind=kind, p_WF=np.array(p_WF), leg=1, **figures)


def at(seeing, p_WF):
    """Loads held and collapsed under in the cell of a place [N]."""
    patch = seeing.patch(np.array(p_WF[:2]), 0, 0, 2.0)
    return patch.held_n[0, 0], patch.collapsed_n[0, 0]


def test_loads_through_a_probing_that_ends_in_a_collapse():
    seeing, place = fresh_map(), (0.35, -0.15, RADIUS)
    seeing.follow(np.zeros(3))
    seeing.note(event("force_held", place, asked_n=40.0, held_n=38.0))
    seeing.note(event("force_held", place, asked_n=60.0, held_n=57.0))
    seeing.note(event("collapse", place, asked_n=90.0))
    seeing.note(event("collapse", place, asked_n=110.0))
    seeing.note(event("force_held", place, asked_n=50.0, held_n=48.0))  # a later hold erases nothing
    seeing.note(event("transition", place, held_n=500.0))
    patch = seeing.patch(np.array(place[:2]), 4, 4, 2.0)
    assert np.isnan(patch.height_m).all()  # loads are known blind, heights are not
    x, y = patch.p_W[0] + 0.02 * np.arange(9), patch.p_W[1] + 0.02 * np.arange(9)
    under = np.hypot(x[:, None] - place[0], y[None, :] - place[1]) <= RADIUS
    assert 4 <= under.sum() <= 9
    np.testing.assert_array_equal(patch.held_n, np.where(under, 57.0, 0.0))
    np.testing.assert_array_equal(patch.collapsed_n, np.where(under, 90.0, 0.0))


def test_an_accepted_foothold_has_held_until_it_gives_way_after_all():
    seeing, place = fresh_map(), (0.31, 0.13, RADIUS)
    seeing.follow(np.zeros(3))
    seeing.note(event("accepted", place, held_n=80.0))
    assert at(seeing, place) == (80.0, 0.0)
    seeing.note(event("late_collapse", place, held_n=95.0))
    assert at(seeing, place) == (0.0, 95.0)  # under which load up to 95 N it gave way nobody knows
    seeing.note(event("force_held", place, held_n=30.0))
    assert at(seeing, place) == (30.0, 95.0)
    seeing.note(event("late_collapse", place))  # a load that nobody knows counts as next to none
    assert at(seeing, place) == (0.0, 1.0)


def test_ground_that_gives_way_under_what_it_has_held_bears_that_no_longer():
    seeing, place = fresh_map(), (0.31, 0.13, RADIUS)
    seeing.follow(np.zeros(3))
    seeing.note(event("accepted", place, held_n=118.0))
    seeing.note(event("collapse", place, asked_n=90.0))
    assert at(seeing, place) == (0.0, 90.0)


def test_loads_go_with_the_window_and_are_off_it_forgotten():
    seeing, place = fresh_map(), (0.35, -0.15, RADIUS)
    seeing.follow(np.zeros(3))
    seeing.note(event("collapse", place, asked_n=90.0))
    seeing.note(event("collapse", (9.0, 9.0, RADIUS), asked_n=90.0))  # far off the map: nothing happens
    seeing.follow(np.array([1.4, 0.3, 0.0]))
    assert seeing.patch(np.array(place[:2]), 0, 0, 2.0).collapsed_n[0, 0] == 90.0
    seeing.follow(np.array([1.7, 0.3, 0.0]))
    seeing.follow(np.zeros(3))
    assert seeing.patch(np.array(place[:2]), 0, 0, 2.0).collapsed_n[0, 0] == 0.0


def test_way_and_drift_make_old_heights_uncertain():
    seeing = fresh_map()
    t = walk(Sight(depth=NOISY), seeing, strolling(30))
    before = seeing.patch(np.array([0.55, 0.0]), 2, 2, t).std_m
    covariance = np.zeros((9, 9))
    covariance[2, 2] = 0.02**2
    far = estimate(t + 1.0, (0.2, 0.0, HEIGHT), covariance=covariance)
    empty = Sight(depth=dataclasses.replace(NOISY, dropout=1.0)).frame(t + 1.0, far.p_WB)
    seeing.see(empty, far, None)
    after = seeing.patch(np.array([0.55, 0.0]), 2, 2, t).std_m
    np.testing.assert_allclose(after, np.hypot(before, 0.02), rtol=0.1)


def test_where_feet_stand_on_what_was_seen_the_drift_is_known():
    sight, seeing = Sight(depth=NOISY), fresh_map()
    t = walk(sight, seeing, strolling(60, x0=-1.0, speed=0.25))
    reference, figures = standing(STANCE + [0.2, 0.0, 0.0])
    covariance = np.zeros((9, 9))
    for z_std in (0.0, 0.02):
        covariance[2, 2], t = z_std**2, t + 0.1
        now = estimate(t, (0.2, 0.0, HEIGHT), **figures, covariance=covariance.copy())
        seeing.see(sight.frame(t, (0.2, 0.0, HEIGHT)), now, reference)
    assert seeing.patch(np.array([0.0, 0.0]), 2, 2, t).std_m.max() < 0.01


@pytest.mark.parametrize("heights", [True, False])
def test_a_snapshot_brings_back_what_it_holds(heights):
    seeing = fresh_map()
    t = walk(Sight(depth=NOISY), seeing, strolling(20))
    seeing.note(event("collapse", (0.35, -0.15, RADIUS), asked_n=90.0))
    again = fresh_map()
    again.restore(seeing.snapshot(heights))
    mine, other = seeing.message(t), again.message(t)
    np.testing.assert_array_equal(mine.p_W, other.p_W)
    np.testing.assert_array_equal(mine.collapsed_n, other.collapsed_n)
    if heights:
        np.testing.assert_array_equal(mine.height_m, other.height_m)
        assert again.seen_t == seeing.seen_t
    else:
        assert np.isnan(other.height_m).all() and again.seen_t is None
