"""One step of the whole-body controller: what fails is said, and what cannot be reached is not asked for."""

from dataclasses import replace

import numpy as np

from surefoot.bus.messages import ControlMode, LegStatus, MotionReference, Policy, StateEstimate
from surefoot.components.component import Inbox, Outbox
from surefoot.components.robot_model import LegKinematics
from surefoot.components.wbc.wbc import Wbc
from surefoot.components.wbc.whole_body_qp import QpFailed
from surefoot.config.deployment import Deployment
from surefoot.config.robot import GRAVITY, load_robot

ROBOT = load_robot("aliengo")
LEGS = LegKinematics(ROBOT)
Q = np.tile(ROBOT.nominal.stand_q, 4)
POSE = np.array([0.0, 0.0, 0.4, 0.0, 0.0, 0.0])
FEET = POSE[:3] + LEGS.position(Q.reshape(4, 3))
UP = np.array([0.0, 0.0, 1.0])


class Step:
    """Steps of a controller whose robot stands still, with a policy that lets it stand."""

    def __init__(self):
        self.wbc = Wbc(Deployment())
        self.wbc.warm_up()
        self.inbox, self.got = Inbox(self.wbc.inputs), []
        self.outbox = Outbox(self.wbc.outputs, lambda key, message: self.got.append(message))

    def __call__(self, t=0.0, q=Q, policy=True, **reference):
        feet = POSE[:3] + LEGS.position(q.reshape(4, 3))
        still = {"t": t, "valid": True, "normal_W": UP}
        estimate = StateEstimate(p_WB=POSE[:3], quat_WB=np.array([1.0, 0.0, 0.0, 0.0]), q=q, p_WF=feet, **still)
        self.inbox.deliver("state/estimate", estimate)
        asked = {"mode": ControlMode.BALANCE, "base_from": POSE, "base_to": POSE, "p_WF": feet, **reference}
        self.inbox.deliver("fsm/reference", MotionReference(**still, **asked))
        if policy:
            x, u = np.zeros((3, 24)), np.zeros((2, 24))
            x[:, 6:12] = POSE
            u[:, 2:12:3] = 0.25 * ROBOT.mass * GRAVITY
            self.inbox.deliver("mpc/policy", Policy(t=t, valid=True, dt=0.015, x=x, u=u, v=np.zeros((3, 18))))
        self.wbc.step(t, self.inbox, self.outbox)
        return self.got[-1]


def test_what_kept_it_from_its_work_is_its_trouble(monkeypatch):
    step = Step()
    assert step().solver == "ok" and step.wbc.trouble == ""

    def fail(task):
        raise QpFailed("whole-body QP: it is not feasible")

    with monkeypatch.context() as broken:
        broken.setattr(step.wbc._qp, "solve", fail)
        assert step(0.004).solver == step.wbc.trouble == "whole-body QP: it is not feasible"
    assert step(0.008).solver == "ok" and step.wbc.trouble == ""
    step(0.2, policy=False)
    assert step(0.3, policy=False).solver == step.wbc.trouble == "no fresh policy: base held for 0.1 s"
    step(0.31, mode=ControlMode.DAMP)
    assert step.wbc.trouble == ""
    step.wbc.step(1.0, step.inbox, step.outbox)
    assert step.wbc.trouble == "state/estimate is missing or stale"


def test_a_swing_target_out_of_reach_asks_for_no_more_than_the_leg_has():
    q = Q.copy()
    q[5] = LEGS.upper[1, 2]  # the front right leg is as long as it gets
    foot = POSE[:3] + LEGS.position(q.reshape(4, 3))[1]
    thigh = POSE[:3] + LEGS.hip_B[1] + [0.0, LEGS.thigh_y[1], 0.0]
    status = np.zeros(4, int)
    status[1] = LegStatus.SWING

    def command(beyond_m):
        return Step()(
            t=1.0, q=q, leg_status=status, swing_leg=1, swing_t1=0.5, swing_lands=False,
            swing_from=foot, swing_to=foot + beyond_m * (foot - thigh) / np.linalg.norm(foot - thigh),
        )  # fmt: skip

    there, within, beyond = command(0.0), command(-0.02), command(0.3)
    for name in ("q", "dq", "tau", "force_W"):
        np.testing.assert_allclose(getattr(beyond, name), getattr(there, name), atol=1e-4, err_msg=name)
    assert np.abs(within.tau - there.tau).max() > 0.5


def test_a_hold_comes_up_from_damping_and_a_way_between_two_postures_has_its_gains_at_once():
    step, settings, damping_kd = Step(), Deployment().wbc, Deployment().hw.damping_kd
    span = {"mode": ControlMode.JOINT, "joint_from": Q, "joint_t0": 0.0, "joint_t1": 1.0}
    begun, half, up = (step(t, joint_to=Q, **span) for t in (0.0, 0.5, 1.5))
    assert not begun.kp.any() and (begun.kd == damping_kd).all()
    assert (half.kp == 0.5 * settings.posture_kp).all() and (
        half.kd == 0.5 * (damping_kd + settings.posture_kd)
    ).all()
    assert (up.kp == settings.posture_kp).all() and (up.kd == settings.posture_kd).all()
    assert all((command.q == Q).all() and not command.dq.any() for command in (begun, half, up))
    assert (step(0.0, joint_to=Q + 0.1, **span).kp == settings.posture_kp).all()


def test_between_postures_without_a_state_machine_it_goes_on_to_the_posture_then_damps():
    step, patience_s = Step(), Deployment().wbc.patience_s
    step(0.0, mode=ControlMode.JOINT, joint_from=Q, joint_to=Q + 0.1, joint_t1=1.0)

    def silent(t):
        step.inbox.deliver("state/estimate", replace(step.inbox.latest("state/estimate"), t=t))
        step.wbc.step(t, step.inbox, step.outbox)
        return step.got[-1]

    assert silent(0.05).solver == "ok"
    there = silent(patience_s - 0.1)
    np.testing.assert_allclose(there.q, Q + 0.1)
    assert there.kp.any() and there.solver == "no fsm/reference for 2.7 s" == step.wbc.trouble
    damped = silent(patience_s + 0.1)
    assert not damped.kp.any() and damped.solver == "no fsm/reference for 2.9 s: is fsm running?"
