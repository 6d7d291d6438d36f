"""The whole-body controller's process: 250 Hz, from estimate, policy and reference to a joint command."""

from __future__ import annotations

from typing import ClassVar

import numpy as np

from surefoot.bus.messages import ControlMode, JointCommand, LegStatus, MotionReference, Policy, StateEstimate
from surefoot.components.component import Component, Inbox, Outbox
from surefoot.components.gait.swing_spline import SwingSpline
from surefoot.components.robot_model import LegKinematics
from surefoot.components.robot_model.rotation import log_rotation, matrix_of, matrix_of_rpy
from surefoot.components.wbc.whole_body_qp import QpFailed, Task, WholeBodyQp
from surefoot.config.deployment import Deployment
from surefoot.config.robot import GRAVITY


class Wbc(Component):
    """Damps, moves the joints between postures, or follows the policy through the whole-body QP."""

    name: ClassVar[str] = "wbc"
    inputs: ClassVar[tuple[str, ...]] = ("state/estimate", "mpc/policy", "fsm/reference")
    outputs: ClassVar[tuple[str, ...]] = ("joint/command",)

    def __init__(self, deployment: Deployment):
        super().__init__(deployment)
        robot = deployment.load_robot()
        self._settings = deployment.wbc
        self._legs = LegKinematics(robot)
        self._reach = robot.nominal.max_leg_length
        self._qp = WholeBodyQp(robot, self._settings)
        self._stand_q = np.tile(robot.nominal.stand_q, 4)
        self._friction = np.array(robot.per_joint("friction"))
        self._damping = np.array(robot.per_joint("damping"))
        self._failures = 0
        self._last_force = np.zeros((4, 3))

    def warm_up(self) -> None:
        """Set the solver up on a standing robot: the first real step only updates it."""
        q = np.concatenate([[0.0, 0.0, 0.4, 0.0, 0.0, 0.0, 1.0], self._stand_q])
        self._qp.update(q, np.zeros(18))
        quarter = np.tile([0.0, 0.0, 0.25 * self._qp.mass * GRAVITY], (4, 1))
        wrench = self._qp.wrench_map @ quarter.ravel()
        self._qp.solve(Task(np.ones(4, bool), wrench, quarter, np.full(4, 1e-2), np.zeros((4, 3))))

    def step(self, t: float, inbox: Inbox, outbox: Outbox) -> None:
        estimate, reference = inbox.fresh("state/estimate", t), inbox.fresh("fsm/reference", t)
        if estimate is None or reference is None or reference.mode == ControlMode.DAMP:
            why = (
                "" if reference is not None and estimate is not None else "estimate or reference missing or stale"
            )
            outbox.publish("joint/command", self._damp(t, why))
        elif reference.mode == ControlMode.JOINT:
            outbox.publish("joint/command", self._posture(t, reference))
        else:
            policy = inbox.fresh("mpc/policy", t)
            outbox.publish("joint/command", self._balance(t, estimate, reference, policy))

    def _damp(self, t: float, why: str) -> JointCommand:
        return JointCommand(t=t, valid=True, kd=np.full(12, self._settings.damping_kd), solver=why or "ok")

    def _posture(self, t: float, reference: MotionReference) -> JointCommand:
        """JOINT mode: from one posture to another, at rest at both ends."""
        duration = max(reference.joint_t1 - reference.joint_t0, 1e-3)
        s = min(max((t - reference.joint_t0) / duration, 0.0), 1.0)
        change = reference.joint_to - reference.joint_from
        return JointCommand(
            t=t,
            valid=True,
            q=reference.joint_from + s**3 * (10.0 - 15.0 * s + 6.0 * s * s) * change,
            dq=(30.0 * s * s * (1.0 - s) ** 2 / duration) * change,
            kp=np.full(12, self._settings.posture_kp),
            kd=np.full(12, self._settings.posture_kd),
            solver="ok",
        )

    def _balance(
        self, t: float, estimate: StateEstimate, reference: MotionReference, policy: Policy | None
    ) -> JointCommand:
        settings, qp = self._settings, self._qp
        R = matrix_of(estimate.quat_WB)
        w, x, y, z = estimate.quat_WB
        q = np.concatenate([estimate.p_WB, [x, y, z, w], estimate.q])
        v = np.concatenate([R.T @ estimate.v_WB_W, estimate.omega_WB_B, estimate.dq])
        qp.update(q, v)
        stance = np.isin(reference.leg_status, (LegStatus.STANCE, LegStatus.PROBING, LegStatus.COLLAPSING))
        p_WB, R_des, v_des, omega_W, planned_force = self._desired(t, reference, policy, stance)
        # A foot that has just left the ground may still carry in the policy: the wrench it was to give is
        # asked of the others, or the base would tip towards it until the next policy comes.
        bias_force = planned_force * stance[:, None]
        linear = qp.mass * (settings.kp * (p_WB - estimate.p_WB) + settings.kd * (v_des - estimate.v_WB_W))
        turn = log_rotation(R_des @ R.T)
        spin = settings.kd * (omega_W - R @ estimate.omega_WB_B)
        wrench = qp.wrench_map @ planned_force.ravel() + np.concatenate(
            [linear, qp.inertia_W @ (settings.kp * turn + spin)]
        )
        crept = reference.p_WF - estimate.p_WF
        acceleration = settings.stance_kp * crept - settings.stance_kd * estimate.v_WF
        kp, q_ref, dq_ref = np.zeros(12), estimate.q.copy(), self._still_feet(estimate, R)
        if reference.swing_leg >= 0 and not stance[reference.swing_leg]:
            leg = reference.swing_leg
            own = slice(3 * leg, 3 * leg + 3)
            acceleration[leg], q_ref[own], dq_ref[own] = self._swing(t, estimate, reference, R)
            kp[own] = settings.joint_kp
        weight = np.where(
            reference.leg_status == LegStatus.PROBING, settings.probe_force_weight, settings.force_weight
        )
        solver = "ok"
        try:
            tau, force = qp.solve(Task(stance, wrench, bias_force, weight, acceleration))
            self._failures, self._last_force = 0, force
        except QpFailed as error:
            self._failures += 1
            if self._failures > settings.failures_max:
                return self._damp(t, str(error))
            solver, force = str(error), self._last_force * stance[:, None]
            tau = qp.torques(force, np.zeros(18))
        # What the motors lose in the joints before it reaches the ground: as much as a light foot presses with.
        loss = self._friction * np.tanh(dq_ref / settings.friction_speed) + self._damping * dq_ref
        tau = tau + np.repeat(stance, 3) * loss
        return JointCommand(
            t=t,
            valid=True,
            q=q_ref,
            dq=dq_ref,
            kp=kp,
            kd=np.full(12, settings.joint_kd),
            tau=tau,
            force_W=force,
            policy_age_s=-1.0 if policy is None else t - policy.t,
            solver=solver,
        )

    def _desired(self, t: float, reference: MotionReference, policy: Policy | None, stance: np.ndarray):
        """Base pose and velocity, and forces: the policy's at time t, or the reference's without a policy."""
        if policy is None:
            duration = max(reference.base_t1 - reference.base_t0, 1e-6)
            share = min(max((t - reference.base_t0) / duration, 0.0), 1.0)
            pose = reference.base_from + share * (reference.base_to - reference.base_from)
            force = np.zeros((4, 3))
            force[stance, 2] = self._qp.mass * GRAVITY / max(int(stance.sum()), 1)
            return pose[:3], matrix_of_rpy(pose[3:]), np.zeros(3), np.zeros(3), force
        position = (t - policy.t) / policy.dt
        k = min(max(int(position), 0), len(policy.u) - 1)
        share = min(max(position - k, 0.0), 1.0)
        x = policy.x[k] + share * (policy.x[k + 1] - policy.x[k])
        R = matrix_of_rpy(x[9:12])
        return x[6:9], R, R @ policy.v[k, :3], R @ policy.v[k, 3:6], policy.u[k, :12].reshape(4, 3)

    def _still_feet(self, estimate: StateEstimate, R: np.ndarray) -> np.ndarray:
        """Joint velocities (12,) [rad/s] that keep the feet still in the world while the base moves."""
        p_BF = (estimate.p_WF - estimate.p_WB) @ R
        carried = R.T @ estimate.v_WB_W + np.cross(estimate.omega_WB_B, p_BF)
        J = self._legs.jacobian(estimate.q.reshape(4, 3))
        damped = J @ J.swapaxes(1, 2) + 1e-4 * np.eye(3)
        return -(J.swapaxes(1, 2) @ np.linalg.solve(damped, carried[..., None])).ravel()

    def _swing(self, t: float, estimate: StateEstimate, reference: MotionReference, R: np.ndarray):
        """Task acceleration of the swing foot, and its joint references by inverse kinematics."""
        leg, settings = reference.swing_leg, self._settings
        p, v, a = (item[0] for item in SwingSpline(reference).sample(np.array([t])))
        error, speed = p - estimate.p_WF[leg], v - estimate.v_WF[leg]
        acceleration = a + settings.swing_kp * error + settings.swing_kd * speed
        length = float(np.sqrt(acceleration @ acceleration))
        acceleration = acceleration * min(1.0, settings.swing_acceleration_max / max(length, 1e-9))
        p_BF = (estimate.p_WF - estimate.p_WB) @ R
        p_BF[leg] = (p - estimate.p_WB) @ R
        q, _ = self._legs.inverse(p_BF)
        J = self._legs.jacobian(q)[leg]
        carried = estimate.v_WB_W + R @ np.cross(estimate.omega_WB_B, p_BF[leg])
        dq = np.linalg.solve(J @ J.T + 1e-4 * np.eye(3), (v - carried) @ R)
        return acceleration, q[leg], J.T @ dq
