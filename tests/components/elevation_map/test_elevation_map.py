"""The process: images meet their estimates, requests are answered, and what is no good is said."""

import dataclasses

import numpy as np
import pytest
from made_up_ground import NOMINAL_BF, RADIUS
from sight import Sight, deployment, estimate

from surefoot.bus.codec import encode
from surefoot.bus.messages import DepthFrame, FootholdRequest, FsmEvent
from surefoot.components.clock_messages import pack_snapshot, unpack_snapshot
from surefoot.components.component import Inbox, Outbox
from surefoot.components.elevation_map.elevation_map import ElevationMap

POSE = (0.0, 0.0, 0.394)
AHEAD = np.array([[0.6, 0.15, 0.0], [0.6, -0.15, 0.0], [0.8, 0.15, 0.0], [0.8, -0.15, 0.0]])


class Desk:
    """A map process and what it has said."""

    def __init__(self, **given):
        self.process = ElevationMap(deployment(**given))
        self.inbox = Inbox(self.process.inputs)
        self.said = []
        self._outbox = Outbox(self.process.outputs, lambda key, message: self.said.append((key, message)))

    def step(self, t, **inputs):
        """One release, with a message or a list of them on inputs."""
        keys = {
            "depth": "hw/depth",
            "estimates": "state/estimate",
            "event": "fsm/event",
            "request": "foothold/request",
        }
        for name, messages in inputs.items():
            for message in messages if isinstance(messages, list) else [messages]:
                self.inbox.deliver(keys[name], message)
        self.process.step(t, self.inbox, self._outbox)
        self.inbox.clear_new()

    def ask(self, t, target_WF=AHEAD, **figures):
        request = FootholdRequest(t=t, valid=True, id=7, target_WF=np.array(target_WF), **figures)
        self.step(t, request=request)
        key, answer = self.said[-1]
        assert key == "foothold/regions" and answer.id == 7 and answer.valid
        return answer

    @property
    def seen(self):
        return self.process.map.seen_t


@pytest.fixture(scope="module")
def image():
    return Sight().frame(0.0, POSE)


def test_an_image_waits_for_the_estimate_of_its_time_and_takes_no_other(image):
    desk = Desk()
    at = [0.098, 0.1, 0.102]
    frame = dataclasses.replace(image, t=at[1])
    desk.step(0.1, depth=frame, estimates=estimate(at[0], POSE))
    assert desk.seen is None
    # The one before would put the ground elsewhere.
    desk.step(0.12, estimates=[estimate(at[1], np.add(POSE, [0.0, 0.0, 0.05])), estimate(at[2], POSE)])
    assert desk.seen == 0.1 and desk.process.trouble == ""
    heights = desk.process.map.patch(AHEAD[0], 3, 3, 0.12).height_m
    assert np.isfinite(heights).sum() > 30
    np.testing.assert_allclose(heights[np.isfinite(heights)], 0.05, atol=0.01)


def test_an_image_whose_estimate_was_lost_is_dropped_and_said(image):
    desk = Desk()
    desk.step(0.12, depth=dataclasses.replace(image, t=0.1), estimates=[estimate(t, POSE) for t in (0.098, 0.102)])
    assert desk.seen is None and "the image of 0.100 s has no state/estimate of its time" in desk.process.trouble
    desk.step(0.2, depth=dataclasses.replace(image, t=0.2), estimates=estimate(0.2, POSE))
    assert desk.seen == 0.2 and desk.process.trouble == ""


def test_an_image_that_waits_in_vain_or_comes_from_the_future_is_dropped(image):
    desk = Desk()
    desk.step(1.0, depth=dataclasses.replace(image, t=1.0))
    desk.step(1.3)
    assert "found no state/estimate within" in desk.process.trouble
    desk.step(1.4, depth=dataclasses.replace(image, t=9.0))
    assert "the image of 9.000 s" in desk.process.trouble
    assert desk.seen is None


NAN = float("nan")


@pytest.mark.parametrize(
    ("wrong", "said"),
    [
        ({"depth_m": np.zeros((0, 0), np.float32)}, "it has no pixels"),
        ({"depth_m": np.full((60, 80), np.nan, np.float32)}, "no pixel has a depth"),
        ({"depth_m": np.zeros((60, 80), np.float32)}, "no pixel has a depth"),
        ({"depth_m": np.full((60, 80), -1.0, np.float32)}, "no pixel has a depth"),
        ({"depth_m": np.full((60, 80), np.inf, np.float32)}, "no pixel has a depth"),
        ({"p_BC": np.array([0.3, NAN, 0.0])}, "pose is not finite"),
        ({"p_BC": np.array([0.3, 0.0, -2.5])}, "the camera is 2.52 m from the trunk's origin, limit 2 m"),
        ({"p_BC": np.full(3, 1e300)}, "from the trunk's origin"),
        ({"quat_BC": np.array([1.0, 0.0, NAN, 0.0])}, "pose is not finite"),
        ({"quat_BC": np.zeros(4)}, "quaternion has length 0.000, not 1"),
        ({"quat_BC": np.array([2.0, 0.0, 0.0, 0.0])}, "quaternion has length 2.000, not 1"),
        ({"fov": np.array([0.0, 1.0])}, "field of view is 0 by 1 rad"),
        ({"fov": np.array([1.5, 4.0])}, "field of view is 1.5 by 4 rad"),
        ({"fov": np.array([NAN, 1.0])}, "field of view"),
        ({"valid": False}, "does not vouch"),
    ],
)
def test_a_bad_image_leaves_the_map_alone_and_is_told_until_a_good_one_comes(image, wrong, said):
    desk = Desk()
    desk.step(0.02, depth=image, estimates=estimate(0.0, POSE))
    before = desk.process.map.message(0.02).height_m
    desk.step(0.1, depth=dataclasses.replace(image, t=0.1, **wrong), estimates=estimate(0.1, POSE))
    assert desk.seen == 0.0 and said in desk.process.trouble
    np.testing.assert_array_equal(desk.process.map.message(0.02).height_m, before)
    desk.step(0.12)
    assert said in desk.process.trouble
    desk.step(0.2, depth=dataclasses.replace(image, t=0.2), estimates=estimate(0.2, POSE))
    assert desk.process.trouble == ""


def test_single_pixels_that_are_no_numbers_are_left_out(image):
    desk, depth = Desk(), image.depth_m.copy()
    depth[::2, ::3] = np.nan
    depth[1::4, ::5] = np.inf
    depth[3::4, ::7] = -2.0
    desk.step(0.02, depth=dataclasses.replace(image, depth_m=depth), estimates=estimate(0.0, POSE))
    grid = desk.process.map.message(0.02)
    assert np.isfinite(grid.height_m).sum() > 500 and np.nanmax(np.abs(grid.height_m)) < 0.02


@pytest.mark.filterwarnings("error")
def test_depths_beyond_the_world_are_left_out(image):
    desk, depth = Desk(), image.depth_m.copy()
    depth[::2] = 3e38
    desk.step(0.02, depth=dataclasses.replace(image, depth_m=depth), estimates=estimate(0.0, POSE))
    grid = desk.process.map.message(0.02)
    assert np.isfinite(grid.height_m).sum() > 500 and np.nanmax(np.abs(grid.height_m)) < 0.02


def test_blind_every_foothold_may_be_anywhere():
    desk = Desk(vision=False)
    answer = desk.ask(1.0)
    np.testing.assert_array_equal(answer.foothold_WF, AHEAD)
    assert answer.safe.all() and not answer.region_active.any()
    assert answer.reasons == ("blind: no depth sensor, so no map",) * 4
    assert desk.process.trouble == "" and len(desk.said) == 1
    assert desk.process.complete == ()  # 500 estimates a second are not even looked at


def test_blind_images_are_ignored_but_loads_are_kept(image):
    desk = Desk(vision=False)
    gone = FsmEvent(t=0.0, valid=True, kind="collapse", leg=0, p_WF=AHEAD[0], asked_n=70.0)
    desk.step(0.1, depth=image, estimates=estimate(0.0, POSE), event=gone)
    patch = desk.process.map.patch(AHEAD[0], 0, 0, 0.1)
    assert np.isnan(patch.height_m[0, 0]) and patch.collapsed_n[0, 0] == 70.0
    assert desk.said == []


def test_before_the_first_image_and_when_images_stay_away_there_is_no_map(image):
    desk = Desk()
    assert desk.ask(0.02).reasons == ("no map: no image yet that could be used",) * 4
    desk.step(0.04, depth=image, estimates=estimate(0.0, POSE))
    assert not desk.ask(0.4).reasons[0].startswith("no map")
    late = desk.ask(0.9)
    np.testing.assert_array_equal(late.foothold_WF, AHEAD)
    assert late.reasons == ("no map: the last good image is 0.9 s old, limit 0.5 s",) * 4
    assert desk.process.trouble == late.reasons[0]


@pytest.mark.parametrize("far", [(1e3, -1e3), (-1e20, 1e20)])
@pytest.mark.filterwarnings("error")
def test_a_target_outside_the_map_or_where_nothing_was_seen_has_no_map(image, far):
    desk = Desk()
    desk.step(0.02, depth=image, estimates=estimate(0.0, POSE))
    targets = AHEAD.copy()
    targets[1, :2], targets[3, :2] = (-0.5, 0.0), far
    answer = desk.ask(0.04, targets)
    np.testing.assert_array_equal(answer.foothold_WF, targets)
    assert [reason.startswith("no map there") for reason in answer.reasons] == [False, True, False, True]
    assert not answer.region_active[[1, 3]].any() and answer.safe[[1, 3]].all()


def test_what_gave_way_is_not_offered_again_and_what_has_held_is_certified(image):
    desk = Desk()
    desk.step(0.02, depth=image, estimates=estimate(0.0, POSE))
    stand = NOMINAL_BF + [0.36, 0.0, RADIUS - NOMINAL_BF[0, 2]]
    base = np.array([0.36, 0.0, stand[0, 2] - NOMINAL_BF[0, 2], 0.0, 0.0, 0.0])
    figures = {"p_WF": stand - [0.1, 0.0, 0.0], "base_target": base, "normal_W": np.array([0.0, 0.0, 1.0])}

    def told(t, kind, leg, **loads):
        verdict = FsmEvent(t=t, valid=True, kind=kind, leg=leg, p_WF=stand[leg], **loads)
        desk.step(t, event=verdict, depth=dataclasses.replace(image, t=t), estimates=estimate(t, POSE))
        return desk.ask(t, stand, **figures)

    answer = told(0.1, "accepted", 0, held_n=88.0)
    assert answer.safe.all() and answer.held_n.tolist() == [88.0, 0.0, 0.0, 0.0]
    np.testing.assert_array_equal(answer.foothold_WF[:2, :2], stand[:2, :2])
    for leg, kind, loads in ((1, "collapse", {"asked_n": 70.0}), (0, "late_collapse", {"held_n": 60.0})):
        answer = told(0.2 + 0.1 * leg, kind, leg, **loads)
        moved = np.hypot(*(answer.foothold_WF[leg] - stand[leg])[:2])
        assert answer.safe[leg] and answer.held_n[leg] == 0.0
        assert moved > RADIUS and "the target's cell is collapsed" in answer.reasons[leg]
        # No point of the region is nearer to the place than a foot is wide.
        A, b = answer.region_a[leg], answer.region_b[leg]
        assert (A @ stand[leg] + b).min() < -RADIUS


def test_the_map_is_told_twice_a_second(image):
    desk = Desk()
    for index in range(101):
        t = 0.02 * index
        desk.step(t, depth=dataclasses.replace(image, t=t), estimates=estimate(t, POSE))
    grids = [message for key, message in desk.said if key == "map/elevation"]
    assert [round(grid.t, 2) for grid in grids] == [0.0, 0.5, 1.0, 1.5, 2.0]
    grid = grids[-1]
    assert grid.height_m.shape == grid.collapsed_n.shape == (120, 80) and grid.height_m.dtype == np.float32
    at = np.round((AHEAD[0, :2] - grid.p_W) / grid.cell_m).astype(int)
    assert abs(grid.height_m[tuple(at)]) < 0.01 and grid.age_s[tuple(at)] < 0.1
    assert np.isnan(grid.height_m[0, 0])


@pytest.mark.parametrize(
    "later",
    [
        estimate(0.022, (0.3, 0.0, 0.394)),  # further than the robot can move in 2 ms
        dataclasses.replace(estimate(0.022, POSE), valid=False),
        dataclasses.replace(estimate(0.022, POSE), boot=1),
    ],
)
def test_an_estimate_that_starts_again_leaves_no_map(image, later):
    desk = Desk(clock="monotonic")
    gone = FsmEvent(t=0.0, valid=True, kind="collapse", leg=0, p_WF=AHEAD[0], asked_n=70.0)
    desk.step(0.02, depth=image, estimates=[estimate(0.0, POSE), estimate(0.02, POSE)], event=gone)
    assert desk.seen == 0.0
    desk.step(0.04, estimates=later)
    grid = desk.process.map.message(0.04)
    assert desk.seen is None and np.isnan(grid.height_m).all() and not grid.collapsed_n.any()


def test_in_simulated_time_a_restarted_estimator_goes_on_in_the_same_frame(image):
    desk = Desk()
    desk.step(0.02, depth=image, estimates=[estimate(0.0, POSE), estimate(0.02, POSE)])
    desk.step(0.04, estimates=dataclasses.replace(estimate(0.022, POSE), boot=1))
    assert desk.seen == 0.0 and np.isfinite(desk.process.map.message(0.04).height_m).any()


def test_a_walking_base_is_no_jump(image):
    desk = Desk()
    desk.step(0.02, depth=image, estimates=estimate(0.0, POSE))
    desk.step(
        0.04, estimates=[estimate(t, (0.5 * t, 0.0, 0.394 + 0.2 * t)) for t in np.arange(0.002, 0.04, 0.002)]
    )
    desk.step(0.3, estimates=estimate(0.3, (0.15, 0.0, 0.4)))  # a gap
    assert desk.seen == 0.0


def test_another_process_takes_over_with_the_map(image):
    desk, heir = Desk(), Desk()
    desk.step(0.02, depth=image, estimates=estimate(0.0, POSE))
    heir.process.restore(desk.process.snapshot())
    mine, other = (each.process.map.message(0.04) for each in (desk, heir))
    np.testing.assert_array_equal(mine.height_m, other.height_m)
    assert heir.ask(0.06).reasons == desk.ask(0.06).reasons


def script(image):
    """Releases of a walk: images before and after the estimates of their times, questions, a verdict."""
    for index in range(40):
        t, inputs = 0.02 * index, {}
        p_WB = np.add(POSE, [0.1 * t, 0.0, 0.002 * np.sin(9.0 * t)])
        covariance = np.zeros((9, 9))
        covariance[2, 2] = 1e-6 * (1.0 + t)
        # The estimates of the cycles since the last release; that of the release itself is not there yet.
        inputs["estimates"] = [
            estimate(round(t - late, 3), p_WB, covariance=covariance) for late in np.arange(0.02, 0.0, -0.002)
        ]
        if index % 4 == 1:
            inputs["depth"] = dataclasses.replace(image, t=round(t - 0.006 * (index % 8 == 1), 3))
        if index == 20:
            inputs["event"] = FsmEvent(t=t, valid=True, kind="collapse", leg=0, p_WF=AHEAD[0], asked_n=70.0)
        if index > 20:
            inputs["request"] = FootholdRequest(t=t, valid=True, id=index, target_WF=AHEAD)
        yield t, inputs


def test_a_process_that_is_restarted_after_every_step_says_the_same(image):
    steady, restarted = Desk(), Desk()
    for t, inputs in script(image):
        steady.step(t, **inputs)
        restarted.step(t, **inputs)
        payload = pack_snapshot(restarted.process.snapshot())
        restarted.process = ElevationMap(deployment())
        restarted.process.restore(unpack_snapshot(payload))
    assert steady.seen == pytest.approx(0.74) and len(steady.said) > 20
    assert [(key, encode(message)) for key, message in restarted.said] == [
        (key, encode(message)) for key, message in steady.said
    ]


def test_a_frame_of_another_size_is_as_good(image):
    desk = Desk()
    small = DepthFrame(
        t=0.0,
        valid=True,
        p_BC=image.p_BC,
        quat_BC=image.quat_BC,
        fov=image.fov,
        depth_m=image.depth_m.reshape(30, 2, 40, 2).mean(axis=(1, 3)),
    )
    desk.step(0.02, depth=small, estimates=estimate(0.0, POSE))
    assert desk.seen == 0.0
