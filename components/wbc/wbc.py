"""The whole-body controller's process: 250 Hz, from estimate, policy and reference to a joint command."""

from __future__ import annotations

from typing import ClassVar, NamedTuple

import numpy as np

from surefoot.bus.messages import ControlMode, JointCommand, MotionReference, Policy, StateEstimate
from surefoot.bus.topics import TOPICS
from surefoot.components.component import Component, Inbox, Outbox
from surefoot.components.footing import is_grounded, is_probing, is_trusted
from surefoot.components.gait.swing_spline import SwingSpline
from surefoot.components.memory import Memory
from surefoot.components.robot_model import LegKinematics
from surefoot.components.robot_model.rotation import cross, log_rotation, matrix_of
from surefoot.components.wbc.base_target import BaseTarget, Target, static_loads
from surefoot.components.wbc.momentum_observer import MomentumObserver
from surefoot.components.wbc.whole_body_qp import QpFailed, Task, WholeBodyQp
from surefoot.config.deployment import Deployment
from surefoot.config.robot import GRAVITY

_DAMPING = 1e-4 * np.eye(3)  # [m^2]: of a leg's inverse velocity kinematics, where it is nearly straight


class _Joints(NamedTuple):
    """What the motors follow beside the torques: (12,) each."""

    q: np.ndarray  # [rad]
    dq: np.ndarray  # [rad/s]
    kp: np.ndarray  # [N m/rad]


class Wbc(Component):
    """Damps, moves the joints between postures, or follows the policy through the whole-body QP.

    It outlives the others: without a fresh policy it holds the base, then lowers it, then damps; without a
    state machine it does the same and puts a foot that is in the air down. Without an estimate it damps.
    """

    name: ClassVar[str] = "wbc"
    inputs: ClassVar[tuple[str, ...]] = (
        "state/estimate",
        "mpc/policy",
        "fsm/reference",
        "operator/tuning",
    )
    outputs: ClassVar[tuple[str, ...]] = ("joint/command",)
    memory: ClassVar[Memory] = Memory(
        "_failures", "_last_force", "_last_t", _target=BaseTarget, _observer=MomentumObserver
    )

    def __init__(self, deployment: Deployment):
        super().__init__(deployment)
        robot = deployment.load_robot()
        self._legs = LegKinematics(robot)
        self._stand_q = np.tile(robot.nominal.stand_q, 4)
        self._friction = np.array(robot.per_joint("friction"))
        self._damping = np.array(robot.per_joint("damping"))
        self._failures = 0
        self._last_force = np.zeros((4, 3))
        self._last_t = 0.0

    def set_up(self) -> None:
        robot, settings = self.deployment.load_robot(), self.deployment.wbc
        self._settings = settings
        self._qp = WholeBodyQp(robot, settings)
        self._target = BaseTarget(settings, robot.mass)
        self._observer = MomentumObserver(settings, robot.mass)

    def warm_up(self) -> None:
        """Set the solver up on a standing robot: the first real step only updates it."""
        q = np.concatenate([[0.0, 0.0, 0.4, 0.0, 0.0, 0.0, 1.0], self._stand_q])
        self._qp.update(q, np.zeros(18))
        quarter = np.tile([0.0, 0.0, 0.25 * self._qp.mass * GRAVITY], (4, 1))
        wrench = self._qp.wrench_map @ quarter.ravel()
        self._qp.solve(Task(np.ones(4, bool), wrench, quarter, np.full(4, 1e-2), np.zeros((4, 3))))

    def step(self, t: float, inbox: Inbox, outbox: Outbox) -> None:
        self.heed_tuning(inbox)
        estimate, reference = inbox.fresh("state/estimate", t), inbox.latest("fsm/reference")
        lost = "state/estimate" if estimate is None else "fsm/reference" if reference is None else ""
        balances = reference is not None and reference.valid and reference.mode == ControlMode.BALANCE
        if not balances or (lost and not self._target.lowered):
            self._target.reset()
            self._observer.reset()
        if lost:
            command = self._damp(t, f"{lost} is missing or stale")
        elif not reference.valid or reference.mode == ControlMode.DAMP:
            command = self._damp(t, "")
        elif reference.mode == ControlMode.JOINT:
            command = self._posture(t, reference)
        else:
            orphaned = inbox.fresh("fsm/reference", t) is None
            policy = None if orphaned else inbox.fresh("mpc/policy", t)
            command = self._balance(t, estimate, reference, policy, orphaned)
        self.trouble = "" if command.solver == "ok" else command.solver
        outbox.publish("joint/command", command)
        self._last_t = t

    def deactivate(self, t: float, inbox: Inbox, outbox: Outbox) -> bool:
        """Brakes every joint, rather than leave it to io to find the last torques too old."""
        outbox.publish("joint/command", self._damp(t, "wbc ends"))
        return True

    def _damp(self, t: float, why: str) -> JointCommand:
        return JointCommand(t=t, valid=True, kd=np.full(12, self.deployment.hw.damping_kd), solver=why or "ok")

    def _posture(self, t: float, reference: MotionReference) -> JointCommand:
        """JOINT mode: from one posture to another, at rest at both ends; to the same one with gains that rise.

        Without its state machine the robot goes on to that posture, then it is damped as one that balances is.
        """
        silent_s = t - reference.t
        orphaned = (
            "" if silent_s <= TOPICS["fsm/reference"].stale_after_s else f"no fsm/reference for {silent_s:.1f} s"
        )
        if silent_s > self._settings.patience_s:
            return self._damp(t, f"{orphaned}: is fsm running?")
        duration = max(reference.joint_t1 - reference.joint_t0, 1e-3)
        s = min(max((t - reference.joint_t0) / duration, 0.0), 1.0)
        change = reference.joint_to - reference.joint_from
        stiff = 1.0 if change.any() else s
        kd = self.deployment.hw.damping_kd * (1.0 - stiff) + self._settings.posture_kd * stiff
        return JointCommand(
            t=t,
            valid=True,
            q=reference.joint_from + s**3 * (10.0 - 15.0 * s + 6.0 * s * s) * change,
            dq=(30.0 * s * s * (1.0 - s) ** 2 / duration) * change,
            kp=np.full(12, self._settings.posture_kp * stiff),
            kd=np.full(12, kd),
            solver=orphaned or "ok",
        )

    def _balance(
        self,
        t: float,
        estimate: StateEstimate,
        reference: MotionReference,
        policy: Policy | None,
        orphaned: bool,
    ) -> JointCommand:
        R, mass = self._take(estimate), self._qp.mass
        stance = _stance(t, estimate, reference, orphaned)
        loads_n = np.zeros(4)
        if policy is None:
            loads_n = static_loads(estimate.p_WF, self._qp.com_W, stance, mass * GRAVITY)
        target = self._target.at(t, policy, estimate.p_WB, R, loads_n)
        if self._target.lowered:
            return self._damp(t, "no policy came back: the base has been lowered; command sit, then stand")
        self._observe(t, reference)
        joints, acceleration = self._feet(t, estimate, reference, R, stance)
        settings = self._settings
        probing = is_probing(reference.leg_status)
        weight = np.where(probing, settings.probe_force_weight, settings.force_weight)
        # A foot that has just left the ground may still carry in the policy: the wrench it was to give is
        # asked of the others, or the base would tip towards it until the next policy comes.
        bias_force = target.force_W * stance[:, None]
        task = Task(stance, self._wrench(estimate, target, R), bias_force, weight, acceleration)
        try:
            tau, force, solver = self._solve(task)
        except QpFailed as error:
            return self._damp(t, str(error))
        # What the motors lose in the joints before it reaches the ground: as much as a light foot presses with.
        loss = self._friction * np.tanh(joints.dq / settings.friction_speed) + self._damping * joints.dq
        return JointCommand(
            t=t,
            valid=True,
            q=joints.q,
            dq=joints.dq,
            kp=joints.kp,
            kd=np.full(12, settings.joint_kd),
            tau=tau + np.repeat(stance, 3) * loss,
            force_W=force,
            policy_age_s=-1.0 if policy is None else t - policy.t,
            solver=solver,
        )

    def _take(self, estimate: StateEstimate) -> np.ndarray:
        """The dynamics at the estimate; R_WB (3, 3)."""
        R = matrix_of(estimate.quat_WB)
        w, x, y, z = estimate.quat_WB
        q = np.concatenate([estimate.p_WB, [x, y, z, w], estimate.q])
        v = np.concatenate([R.T @ estimate.v_WB_W, estimate.omega_WB_B, estimate.dq])
        self._qp.update(q, v)
        return R

    def _wrench(self, estimate: StateEstimate, target: Target, R: np.ndarray) -> np.ndarray:
        """(6,) force and moment about the centre of mass that the feet are to give [N, N m].

        What the policy's forces give and the impedance that draws the base to its target, less what pushes it.
        """
        settings, qp = self._settings, self._qp
        linear = settings.kp * (target.p_WB - estimate.p_WB) + settings.kd * (target.v_WB_W - estimate.v_WB_W)
        turn = settings.kp * log_rotation(target.R_WB @ R.T)
        turn += settings.kd * (target.omega_WB_W - R @ estimate.omega_WB_B)
        impedance = np.concatenate([qp.mass * linear, qp.inertia_W @ turn])
        return qp.wrench_map @ target.force_W.ravel() + impedance - self._observer.wrench_W

    def _feet(
        self, t: float, estimate: StateEstimate, reference: MotionReference, R: np.ndarray, stance: np.ndarray
    ) -> tuple[_Joints, np.ndarray]:
        """References of the joints, and the accelerations (4, 3) that the feet are to have [m/s^2]."""
        settings = self._settings
        crept = (reference.p_WF - estimate.p_WF) * is_grounded(reference.leg_status)[:, None]
        acceleration = settings.stance_kp * crept - settings.stance_kd * estimate.v_WF
        q, dq, kp = estimate.q.copy(), self._still_feet(estimate, R), np.zeros(12)
        leg = reference.swing_leg
        if leg >= 0 and not stance[leg]:
            own = slice(3 * leg, 3 * leg + 3)
            acceleration[leg], q[own], dq[own] = self._swing(t, estimate, reference, R)
            kp[own] = settings.joint_kp
        return _Joints(q, dq, kp), acceleration

    def _solve(self, task: Task) -> tuple[np.ndarray, np.ndarray, str]:
        """Torques (12,) [N m], forces (4, 3) [N], and in words what they are made of.

        Where the QP fails the forces of the last cycle are kept.

        Raises:
            QpFailed: more often in succession than `failures_max`.
        """
        held = self._target.held_s
        try:
            tau, force = self._qp.solve(task)
        except QpFailed as error:
            self._failures += 1
            if self._failures > self._settings.failures_max:
                raise
            force = self._last_force * task.stance[:, None]
            return self._qp.torques(force, np.zeros(18)), force, str(error)
        self._failures, self._last_force = 0, force
        return tau, force, "ok" if held == 0.0 else f"no fresh policy: base held for {held:.1f} s"

    def _observe(self, t: float, reference: MotionReference) -> None:
        """The momentum observer sees the forces of the last cycle while every foot is trusted."""
        qp, dt = self._qp, t - self._last_t
        if is_trusted(reference.leg_status).all() and 0.0 < dt < self._settings.observer_gap_s:
            self._observer.update(qp.momentum_W, qp.wrench_map @ self._last_force.ravel(), dt)
        else:
            self._observer.freeze()

    def _still_feet(self, estimate: StateEstimate, R: np.ndarray) -> np.ndarray:
        """Joint velocities (12,) [rad/s] that keep the feet still in the world while the base moves."""
        p_BF = (estimate.p_WF - estimate.p_WB) @ R
        carried = R.T @ estimate.v_WB_W + cross(estimate.omega_WB_B, p_BF)
        J = self._legs.jacobian(estimate.q.reshape(4, 3))
        damped = J @ J.swapaxes(1, 2) + _DAMPING
        return -(J.swapaxes(1, 2) @ np.linalg.solve(damped, carried[..., None])).ravel()

    def _swing(self, t: float, estimate: StateEstimate, reference: MotionReference, R: np.ndarray):
        """Task acceleration of the swing foot, and its joint references by inverse kinematics."""
        leg, settings = reference.swing_leg, self._settings
        p, v, a = (item[0] for item in SwingSpline(reference).sample(np.array([t])))
        p_BF = (estimate.p_WF - estimate.p_WB) @ R
        p_BF[leg] = (p - estimate.p_WB) @ R
        q, reachable = self._legs.inverse(p_BF)
        if not reachable[leg]:
            # The QP would drag the base after the foot: it is to rest where the leg ends, in the same direction.
            p_BF[leg] = self._legs.position(q)[leg]
            p, v, a = estimate.p_WB + R @ p_BF[leg], np.zeros(3), np.zeros(3)
        error, speed = p - estimate.p_WF[leg], v - estimate.v_WF[leg]
        acceleration = a + settings.swing_kp * error + settings.swing_kd * speed
        length = float(np.sqrt(acceleration @ acceleration))
        acceleration = acceleration * min(1.0, settings.swing_acceleration_max / max(length, 1e-9))
        J = self._legs.jacobian(q)[leg]
        carried = estimate.v_WB_W + R @ cross(estimate.omega_WB_B, p_BF[leg])
        dq = np.linalg.solve(J @ J.T + _DAMPING, (v - carried) @ R)
        return acceleration, q[leg], J.T @ dq


def _stance(t: float, estimate: StateEstimate, reference: MotionReference, orphaned: bool) -> np.ndarray:
    """(4,) the feet that bear. Without the state machine nobody else tells when one on its way down has landed."""
    landed = orphaned & (t > reference.swing_t1) & estimate.contact
    return is_grounded(reference.leg_status) | landed
