"""A stride on flat ground: what the next foothold has to bear."""

from dataclasses import replace

import numpy as np
import pytest
from standing import LEGS, ROBOT, WEIGHT

from surefoot.bus.codec import check
from surefoot.bus.messages import PlanRequest, StateEstimate
from surefoot.components.component import Inbox, Outbox
from surefoot.components.trajopt.envelope import grf_envelope
from surefoot.components.trajopt.stride import Stride
from surefoot.components.trajopt.trajopt import Trajopt
from surefoot.config.deployment import Deployment
from surefoot.config.fsm import Fsm
from surefoot.config.robot import GRAVITY
from surefoot.config.trajopt import Trajopt as Settings

Q = np.tile(ROBOT.nominal.stand_q, 4)
BASE = np.array([0.0, 0.0, 0.4])
FEET = BASE + LEGS.position(Q.reshape(4, 3))
FORWARD = np.array([0.10, 0.0, 0.0])
CRAWL = np.array([2, 0, 3, 1])
UP = np.array([0.0, 0.0, 1.0])
REQUEST = PlanRequest(
    id=7,
    valid=True,
    p_WF=FEET,
    target_WF=FEET + FORWARD,
    base_target=np.concatenate([BASE + FORWARD, np.zeros(3)]),
    normal_W=UP,
)
ESTIMATE = StateEstimate(valid=True, p_WB=BASE, quat_WB=np.array([1.0, 0, 0, 0]), q=Q, p_WF=FEET)


def plan(first, request=REQUEST, estimate=ESTIMATE, **settings):
    return plan_and_trouble(first, request, estimate, **settings)[0]


def plan_and_trouble(first, request=REQUEST, estimate=ESTIMATE, **settings):
    component, got = Trajopt(Deployment(trajopt=Settings(**settings))), []
    inbox = Inbox(component.inputs)
    inbox.deliver("trajopt/request", replace(request, leg_order=np.roll(CRAWL, -first)))
    if estimate is not None:
        inbox.deliver("state/estimate", estimate)
    component.step(0.0, inbox, Outbox(component.outputs, lambda key, message: got.append(check(message))))
    return got[0], component.trouble


@pytest.mark.parametrize("first", range(4))
def test_the_envelope_is_what_a_quasi_static_crawl_needs(first):
    result = plan(first)
    assert result.valid and result.status == "ok" and result.id == 7
    assert result.iterations < Settings().iterations  # it has converged
    normal = result.envelope_W[:, 2]
    assert np.all(np.diff(normal) >= 0.0)
    # While a neighbour swings the foot and the one opposite carry nearly all; the base sways three centimetres to
    # the other side, which leaves the foot 0.44 of the weight. While the opposite one swings it has least to do.
    assert 0.42 * WEIGHT < normal.max() < 0.46 * WEIGHT
    assert 0.19 * WEIGHT < normal.min() < 0.25 * WEIGHT
    assert np.all(np.hypot(*result.envelope_W[:, :2].T) < 0.12 * normal)


@pytest.mark.parametrize("first", range(4))
@pytest.mark.parametrize("trim_s", [0.05, 0.62])
def test_the_envelope_is_that_of_the_first_legs_stance_in_the_plan(first, trim_s):
    result = plan(first, envelope_trim_s=trim_s)
    leg, t = CRAWL[first], result.dt * np.arange(len(result.u))
    stance = (t > 1.0 + trim_s - 1e-9) & (t < 4.0 - trim_s + 1e-9)
    force = result.u[stance, 3 * leg : 3 * leg + 3]
    for pick in (np.max, np.min):
        np.testing.assert_array_equal(pick(result.envelope_W, axis=0), pick(force, axis=0))


@pytest.mark.parametrize("first", range(4))
def test_the_plan_moves_one_leg_after_the_other_and_obeys_newton(first):
    result = plan(first)
    force = result.u[:, :12].reshape(-1, 4, 3)
    t = result.dt * np.arange(len(force))
    for place, leg in enumerate(np.roll(CRAWL, -first)):
        swings = (t > place + 0.35 - 1e-9) & (t < place + 1.0 - 1e-9)
        np.testing.assert_array_equal(force[:, leg, 2] == 0.0, swings)
    acceleration = np.diff(result.x[:, :3], axis=0) / result.dt
    expected = force.sum(axis=1) / ROBOT.mass - [0.0, 0.0, GRAVITY]
    np.testing.assert_allclose(acceleration, expected, atol=1e-9)


def test_a_certified_foothold_bears_no_more_until_its_leg_swings():
    def front_left(**settings):
        force = plan(3, replace(REQUEST, force_max_n=certified), **settings).u[:, 2]
        return force[: round(2.35 / 0.05)].max()  # it is the third to swing

    certified = np.zeros(4)
    free = front_left()
    certified[0] = free - 6.0
    assert front_left() < free - 4.0


def test_nobody_has_tried_the_foothold_that_a_leg_swings_to():
    certified = np.array([130.0, 0.0, 120.0, 60.0])
    request = replace(REQUEST, force_max_n=certified, leg_order=CRAWL)
    limits = Stride(ROBOT, Settings(), Fsm()).sample(request, np.concatenate([BASE, np.zeros(3)])).force_max_n
    t = 0.05 * np.arange(81)
    for place, leg in enumerate(CRAWL):
        now = certified[leg] or np.inf
        before, after = t < place + 0.35 - 1e-9, t > place + 1.0 + 1e-9
        np.testing.assert_allclose(limits[before, leg], now)
        assert np.isinf(limits[after, leg]).all()


def test_a_heading_that_passes_pi_turns_the_nearer_way():
    def ahead(yaw):
        return np.array([*BASE, 0.0, 0.0, yaw])

    R = (
        Stride(ROBOT, Settings(), Fsm())
        .sample(replace(REQUEST, base_target=ahead(0.1 - np.pi)), ahead(np.pi))
        .R_WB
    )
    assert (R[:, 0, 0] < np.cos(np.pi - 0.11)).all()


def test_blind_the_footholds_are_the_targets_and_the_base_arrives():
    result = plan(0)
    np.testing.assert_array_equal(result.footholds_WF, REQUEST.target_WF)
    assert result.x[-1, 6] == pytest.approx(0.10, abs=0.03)
    assert result.x.shape == (81, 24) and result.u.shape == (80, 24)


def test_adapted_footholds_are_in_their_regions_at_the_height_of_the_ground_there():
    ground = np.array([[0.0, 0.0, 0.03], [0.0, 0.0, -0.02], [0.0, 0.0, 0.01], [0.0, 0.0, 0.0]])
    target = FEET + FORWARD + ground
    A = np.array([[1.0, 0.0, 0.0], [-1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, -1.0, 0.0]])
    centre = target - [0.03, 0.0, 0.0]
    b = 0.02 - np.array([A @ point for point in centre])
    active = np.array([True, False, True, True])
    request = replace(REQUEST, target_WF=target, region_a=np.tile(A, (4, 1, 1)), region_b=b, region_active=active)
    result = plan(0, request)
    assert result.status == "ok"
    np.testing.assert_array_equal(result.footholds_WF[:, 2], target[:, 2])
    np.testing.assert_array_equal(result.footholds_WF[1], target[1])
    # The target is 1 cm outside its region; the foot that moves first is the one whose foothold is used.
    leg = CRAWL[0]
    assert (A @ target[leg] + b[leg]).min() == pytest.approx(-0.01)
    assert (A @ result.footholds_WF[leg] + b[leg]).min() > -0.001


def test_without_an_estimate_the_plan_says_so():
    result, trouble = plan_and_trouble(0, estimate=None)
    assert not result.valid and "is the estimator running" in result.status
    assert trouble == result.status


def test_a_plan_that_fails_is_its_trouble():
    result, trouble = plan_and_trouble(0, replace(REQUEST, base_target=np.full(6, np.nan)))
    assert not result.valid and trouble == result.status != ""
    assert plan_and_trouble(0)[1] == ""


def test_the_envelope_takes_whole_vectors_at_the_extrema():
    t = 0.1 * np.arange(10)
    force = np.column_stack([np.sin(t), np.cos(t), 50.0 + 10.0 * np.sin(7.0 * t)])
    envelope = grf_envelope(t, force, 0.1, 0.8, UP)
    inside = force[1:9]
    for axis in range(3):
        assert inside[:, axis].max() in envelope[:, axis]
        assert inside[:, axis].min() in envelope[:, axis]
    assert all(any(np.array_equal(row, vector) for vector in inside) for row in envelope)
