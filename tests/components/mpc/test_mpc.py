"""The MPC's process: references on the nodes, policies a robot can stand on, failures by name."""

from dataclasses import replace

import numpy as np
import pinocchio as pin
import pytest
from standing import LEGS, ROBOT, WEIGHT

from surefoot.bus.codec import check
from surefoot.bus.messages import ControlMode, LegStatus, MotionReference, StateEstimate
from surefoot.components.component import Inbox, Outbox
from surefoot.components.mpc.motion_sampler import MotionSampler
from surefoot.components.mpc.mpc import Mpc
from surefoot.components.robot_model import build_model
from surefoot.components.robot_model.rotation import matrix_of_rpy
from surefoot.config.deployment import Deployment
from surefoot.config.mpc import Mpc as Settings
from surefoot.config.robot import GRAVITY

Q = np.tile(ROBOT.nominal.stand_q, 4)
POSE = np.array([0.0, 0.0, 0.4, 0.0, 0.0, 0.0])
FEET = POSE[:3] + LEGS.position(Q.reshape(4, 3))
STAND = MotionReference(
    valid=True,
    mode=ControlMode.BALANCE,
    base_from=POSE,
    base_to=POSE,
    p_WF=FEET,
    normal_W=np.array([0.0, 0.0, 1.0]),
)


def estimate(t=0.0, **changes):
    figures = {
        "t": t,
        "valid": True,
        "p_WB": POSE[:3],
        "quat_WB": np.array([1.0, 0, 0, 0]),
        "q": Q,
        "p_WF": FEET,
    }
    return StateEstimate(**{**figures, **changes})


def swinging():
    return replace(
        STAND, swing_leg=1, swing_t0=0.3, swing_t1=0.9, swing_from=FEET[1], swing_to=FEET[1] + [0.1, 0, 0],
        swing_height=0.08, swing_v_lift=0.1, swing_v_touch=0.1,
    )  # fmt: skip


def test_a_swing_is_sampled_on_the_nodes_and_its_landing_is_not_counted_on():
    nodes = MotionSampler(ROBOT, 67, 0.015).sample(swinging(), 0.0)
    np.testing.assert_array_equal(nodes.contact[:, 1], nodes.t < 0.3)
    assert nodes.contact[:, [0, 2, 3]].all()
    np.testing.assert_allclose(nodes.p_WF[-1, 1], FEET[1] + [0.1, 0.0, 0.0])
    np.testing.assert_allclose(nodes.force_W.sum(axis=1)[:, 2], WEIGHT)
    np.testing.assert_allclose(nodes.p_WB[:, None] + LEGS.position(nodes.q), nodes.p_WF, atol=1e-9)


def square(centre_W, half_m):
    """Half-spaces A p + b >= 0 of a square about a point (3,), sides along the world's axes."""
    A = np.array([[1.0, 0.0, 0.0], [-1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, -1.0, 0.0]])
    return A, half_m - A @ centre_W


def test_a_region_acts_on_the_swing_leg_from_the_end_of_its_swing_on():
    A, b = square(FEET[1] + [0.1, 0.0, 0.0], 0.03)
    swing = replace(swinging(), region_a=A, region_b=b, region_active=True)
    nodes = MotionSampler(ROBOT, 67, 0.015).sample(swing, 0.0)
    np.testing.assert_array_equal(nodes.region_active[:, 1], nodes.t >= 0.9 - 0.2 * 0.6)
    assert not nodes.region_active[:, [0, 2, 3]].any()
    np.testing.assert_array_equal(nodes.region_a[1], A)
    np.testing.assert_array_equal(nodes.region_b[1], b)
    late = MotionSampler(ROBOT, 67, 0.015).sample(replace(swing, swing_t1=1.03), 1.0)
    assert late.region_active[:, 1].all()
    without = MotionSampler(ROBOT, 67, 0.015).sample(replace(swing, region_active=False), 0.0)
    assert not without.region_active.any() and not without.region_a.any()
    # What one sample writes must not leak into the next one's "no region".
    assert not MotionSampler(ROBOT, 67, 0.015).sample(STAND, 0.0).region_a.any()


def test_a_swing_to_a_point_outside_its_region_is_planned_to_come_down_inside():
    A, b = square(FEET[1] + [0.05, 0.0, 0.0], 0.03)  # the swing aims 2 cm beyond its front edge
    ends = []
    for region in (False, True):
        loop = Loop()
        swing = replace(swinging(), region_a=A, region_b=b, region_active=region)
        for tick in range(25):
            policy = loop.tick(0.01 * tick, swing)
        foot = policy.x[-2, 6:9] + LEGS.position(policy.x[-2, 12:].reshape(4, 3))[1]
        ends.append((A @ foot + b).min())
    assert ends[0] < -0.01 and ends[1] > ends[0] + 0.01


def test_certified_loads_cap_the_nodes_and_unknown_ones_do_not():
    sample = MotionSampler(ROBOT, 67, 0.015).sample
    nodes = sample(replace(STAND, force_max_n=np.array([130.0, 0.0, 30.0, 119.0])), 0.0)
    np.testing.assert_allclose(nodes.force_max_n, np.tile([130.0, np.inf, 30.0, 119.0], (68, 1)))
    assert np.isinf(sample(STAND, 0.0).force_max_n).all()


def test_the_policy_loads_no_foot_above_its_certificate():
    lean = replace(STAND, base_to=POSE + [0.18, 0.10, 0.0, 0.0, 0.0, 0.0])  # towards the front left foot
    most = []
    for certified in (0.0, 115.0):
        loop = Loop()
        force_max_n = np.array([certified, 0.0, 0.0, 0.0])
        for tick in range(30):
            policy = loop.tick(0.01 * tick, replace(lean, force_max_n=force_max_n))
        most.append(policy.u[:60, 2].max())
    assert most[0] > 125.0 and most[1] < most[0] - 15.0


def test_probing_forces_follow_each_other_with_a_blend():
    forces = np.array([[0.0, 0.0, 20.0]] + [[0.0, 0.0, 40.0 + 10.0 * i] for i in range(6)])
    reference = replace(
        STAND, probe_leg=2, probe_t0=0.1, probe_dwell_s=0.1, probe_blend_s=0.03, probe_force_W=forces
    )
    nodes = MotionSampler(ROBOT, 100, 0.01).sample(reference, 0.0)
    active = nodes.probe_leg == 2
    np.testing.assert_array_equal(np.flatnonzero(active), np.arange(10, 70))
    assert nodes.probe_force_W[19, 2] == pytest.approx(40.0)
    assert nodes.probe_force_W[21, 2] == pytest.approx(40.0 + 10.0 / 3.0)


class Loop:
    def __init__(self, settings=None):
        self.mpc = Mpc(Deployment(mpc=settings or Settings()))
        self.mpc.warm_up()
        self.inbox, self.got = Inbox(self.mpc.inputs), []
        self.outbox = Outbox(self.mpc.outputs, lambda key, message: self.got.append(check(message)))

    def tick(self, t, reference, state=None):
        self.inbox.deliver("state/estimate", state or estimate(t))
        self.inbox.deliver("fsm/reference", replace(reference, t=t))
        self.mpc.step(t, self.inbox, self.outbox)
        return self.got[-1] if self.got else None


def test_a_standing_robot_gets_a_policy_that_holds_it():
    loop = Loop()
    for tick in range(20):
        policy = loop.tick(0.01 * tick, STAND)
    assert policy.valid and policy.solver == "ok"
    forces = policy.u[:30, :12].reshape(-1, 4, 3)
    np.testing.assert_allclose(forces.sum(axis=1)[:, 2], WEIGHT, rtol=0.01)
    assert dict(zip(policy.constraint, policy.violation, strict=True))["friction_cone"] == 0.0


def test_a_policy_tells_how_long_each_stage_of_its_tick_took():
    policy = Loop().tick(0.0, STAND)
    assert policy.stage == ("references", "linearise", "quadratic", "riccati", "step", "policy")
    assert len(policy.stage_ms) == 6 and np.all(policy.stage_ms > 0.0)


def test_a_swing_leg_is_unloaded_and_follows_its_spline():
    loop = Loop()
    for tick in range(25):
        policy = loop.tick(0.01 * tick, swinging())
    times = policy.t + policy.dt * np.arange(67)
    in_air = (times >= 0.3) & (times < 0.9)
    force = policy.u[:, 3:6]
    assert not force[in_air].any()
    p_WF = policy.x[:, 6:9] + LEGS.position(policy.x[:, 12:].reshape(-1, 4, 3))[:, 1]
    nodes = MotionSampler(ROBOT, 67, 0.015).sample(swinging(), policy.t)
    assert np.abs(p_WF - nodes.p_WF[:, 1])[:60].max() < 0.02


@pytest.mark.parametrize("status", [LegStatus.STANCE, LegStatus.SWING])
def test_a_plan_begins_with_the_momentum_that_the_forces_until_then_give(status):
    loop, lean = Loop(), replace(STAND, base_to=POSE + [0.05, 0.03, 0.0, 0.0, 0.0, 0.0], base_t1=0.3)
    first, second = (loop.tick(t, lean) for t in (0.0, 0.01))
    # What a foot that is lost since then was to give is asked of the others: it makes no difference.
    third = loop.tick(0.02, replace(lean, leg_status=np.array([0, status, 0, 0], np.uint8)))
    # The third plan begins at 35 ms: until 25 ms the first one acts, then the second.
    impulse = 0.005 * first.u[0, :12].reshape(4, 3) + 0.010 * second.u[0, :12].reshape(4, 3)
    assert not np.allclose(first.u[0, :12], second.u[0, :12], atol=1.0)
    expected = impulse.sum(axis=0) / ROBOT.mass - [0.0, 0.0, 0.015 * GRAVITY]
    np.testing.assert_allclose(third.x[0, :3], expected, atol=1e-9)


def moments(policy):
    """(3,) moment of a policy's first forces about the centre of mass, and the one that its states tell [N m]."""
    model, x = build_model(ROBOT), policy.x[0]
    R = matrix_of_rpy(x[9:12])
    q = np.concatenate([x[6:9], pin.Quaternion(R).coeffs(), x[12:]])
    com_W = pin.centerOfMass(model, model.createData(), q)
    lever = x[6:9] + LEGS.position(x[12:].reshape(4, 3)) @ R.T - com_W
    told = ROBOT.mass / policy.dt * (policy.x[1, 3:6] - x[3:6])
    return np.cross(lever, policy.u[0, :12].reshape(4, 3)).sum(axis=0), told


@pytest.mark.parametrize("profile", ["paper", "light"])
def test_when_a_foot_is_lost_the_forces_of_the_plan_do_what_its_states_say(profile):
    base = POSE + [-0.03, 0.05, 0.0, 0.0, 0.0, 0.0]  # inside the three feet that stay
    pressing = replace(
        STAND, base_from=base, base_to=base, probe_leg=1, probe_t0=-0.2, probe_dwell_s=1.0, probe_blend_s=0.03,
        probe_force_W=np.tile([0.0, 0.0, 80.0], (7, 1)),
    )  # fmt: skip
    up = FEET[1] + [0.0, 0.0, 0.08]
    lost = replace(pressing, probe_leg=-1, swing_leg=1, swing_t1=0.6, swing_from=FEET[1], swing_to=up)
    q = LEGS.inverse((FEET - base[:3])[None])[0].ravel()
    gap_nm = {}
    for iterations in (1, 3):
        loop = Loop(Settings(profile=profile, iterations=iterations))
        for tick in range(16):
            reference, state = pressing if tick < 15 else lost, estimate(0.02 * tick, p_WB=base[:3], q=q)
            policy = loop.tick(0.02 * tick, reference, state)
        done, told = moments(policy)
        gap_nm[iterations] = np.abs(done - told).max()
    assert gap_nm[3] < 1.0 < 5.0 < gap_nm[1], gap_nm


def test_no_policy_without_a_reference_to_balance():
    loop = Loop()
    assert loop.tick(0.0, replace(STAND, mode=ControlMode.JOINT)) is None


def test_a_failing_solver_is_named_and_the_next_tick_recovers():
    loop = Loop()
    loop.tick(0.0, STAND)
    loop.mpc._iterate.h[:] = np.nan
    policy = loop.tick(0.01, STAND)
    assert not policy.valid and "riccati" in policy.solver
    assert loop.mpc.trouble == policy.solver
    assert loop.tick(0.02, STAND).valid and loop.mpc.trouble == ""


def test_an_old_estimate_is_its_trouble_and_another_mode_is_none():
    loop = Loop()
    loop.tick(1.0, STAND, estimate(0.0))
    assert loop.mpc.trouble == "state/estimate is missing or stale"
    loop.tick(1.0, replace(STAND, mode=ControlMode.DAMP))
    assert loop.mpc.trouble == ""
