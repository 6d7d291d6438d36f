"""The MPC's process: from estimate and reference to a policy, at every tick (Sec. II-C)."""

from __future__ import annotations

from dataclasses import replace
from time import perf_counter
from typing import ClassVar

import numpy as np
import pinocchio as pin

from surefoot.bus.messages import ControlMode, MotionReference, Policy, StateEstimate
from surefoot.components.component import Component, Inbox, Outbox
from surefoot.components.footing import is_grounded
from surefoot.components.memory import Memory
from surefoot.components.mpc.motion_sampler import MotionSampler
from surefoot.components.ocp.centroidal_dynamics import Trajectory
from surefoot.components.ocp.node_reference import NodeReference
from surefoot.components.ocp.problem import Problem, State, Step, policy_states
from surefoot.components.ocp.riccati import SolverFailed
from surefoot.components.robot_model import build_model
from surefoot.components.robot_model.rotation import exp_rotation, matrix_of, skew
from surefoot.components.robot_model.rotations import exp_rotations, log_rotations
from surefoot.config.deployment import Deployment
from surefoot.config.robot import GRAVITY


class _Stopwatch:
    """Wall time of each stage of a tick, of one that comes again in all: nothing else in the step reads it."""

    def __init__(self) -> None:
        self.stage_ms: dict[str, float] = {}
        self.stage_begun = perf_counter()

    def mark(self, stage: str) -> None:
        now = perf_counter()
        self.stage_ms[stage] = self.stage_ms.get(stage, 0.0) + 1e3 * (now - self.stage_begun)
        self.stage_begun = now


class Mpc(Component):
    """One SQP iteration a tick, warm-started by shifting the last trajectory by the time that has passed.

    Where its step was too large to be taken in full, as at an event, others follow in the same tick. A solver
    that fails is reported by name in an invalid policy, and the next tick starts cold.
    """

    name: ClassVar[str] = "mpc"
    inputs: ClassVar[tuple[str, ...]] = ("state/estimate", "fsm/reference", "operator/tuning")
    outputs: ClassVar[tuple[str, ...]] = ("mpc/policy",)
    memory: ClassVar[Memory] = Memory("_contact", "_force_before_W", "_t", _iterate=Trajectory)

    def __init__(self, deployment: Deployment):
        super().__init__(deployment)
        robot, settings = deployment.load_robot(), deployment.mpc
        self._dt = settings.interval_s
        self._sampler = MotionSampler(robot, settings.intervals, settings.interval_s)
        self._model = build_model(robot)
        self._data = self._model.createData()
        self._mass = robot.mass
        self._stand_q = np.tile(robot.nominal.stand_q, 4)
        self._height = robot.nominal.leg_height
        self._iterate: Trajectory | None = None
        self._contact: np.ndarray | None = None
        self._force_before_W = np.zeros((4, 3))
        self._t = 0.0

    def set_up(self) -> None:
        deployment = self.deployment
        self._problem = Problem(deployment.ocp, deployment.load_robot(), deployment.mpc.intervals)

    def warm_up(self) -> None:
        """One solve for a standing robot: the first real tick is as fast as any."""
        pose = np.array([0.0, 0.0, self._height, 0.0, 0.0, 0.0])
        legs = self._sampler.legs.position(self._stand_q.reshape(4, 3))
        reference = MotionReference(
            base_from=pose, base_to=pose, p_WF=pose[:3] + legs, normal_W=np.array([0.0, 0.0, 1.0])
        )
        nodes = self._sampler.sample(reference, 0.0)
        state = State(np.zeros(6), pose[:3], np.eye(3), self._stand_q.reshape(4, 3))
        self._problem.converge(nodes, state, 2, 0.0)

    def step(self, t: float, inbox: Inbox, outbox: Outbox) -> None:
        self.heed_tuning(inbox)
        estimate, reference = inbox.fresh("state/estimate", t), inbox.fresh("fsm/reference", t)
        lost = "state/estimate" if estimate is None else "fsm/reference" if reference is None else ""
        self.trouble = f"{lost} is missing or stale" if lost else ""
        if lost or reference.mode != ControlMode.BALANCE:
            self._iterate = None
            return
        watch = _Stopwatch()
        # The policy is acted on only after the solve and the command's way to the motors: plan from there.
        lead = self.deployment.mpc.lead_s
        begins = t + lead
        nodes = self._sampler.sample(reference, begins)
        force_W = self._acting(t, reference)
        measured = self._predict(self.measured(estimate), estimate, force_W, lead)
        start = self._warm_start(nodes, begins)
        watch.mark("references")
        try:
            step = self._solve(start, nodes, measured, watch)
        except SolverFailed as error:
            self._iterate, self.trouble = None, str(error)
            outbox.publish("mpc/policy", Policy(t=begins, dt=self._dt, solver=self.trouble))
            return
        self._force_before_W = force_W if self._iterate is None else self._planned(self._iterate, begins - 1e-6)
        self._iterate, self._contact, self._t = step.iterate, nodes.contact, begins
        self._publish(begins, nodes, step, watch, outbox)

    def _solve(self, start: Trajectory, nodes: NodeReference, measured: State, watch: _Stopwatch) -> Step:
        """SQP iterations until a step has been taken in full, `iterations` at the most.

        When a foot is lost, the last plan is far from a new one, and a plan half way between them is none: its
        forces do not do to the base what its states say, and a robot that follows them is thrown over.

        Raises:
            SolverFailed: a QP has no solution.
        """
        step = self._problem.iterate(start, nodes, measured, watch.mark)
        for _ in range(1, self.deployment.mpc.iterations):
            if step.scale == 1.0:
                break
            step = self._problem.iterate(step.iterate, nodes, measured, watch.mark)
        return step

    def measured(self, estimate: StateEstimate) -> State:
        """The state x of an estimate: momentum from the base's and the joints' velocities."""
        R = matrix_of(estimate.quat_WB)
        w, x, y, z = estimate.quat_WB
        q = np.concatenate([estimate.p_WB, [x, y, z, w], estimate.q])
        v = np.concatenate([R.T @ estimate.v_WB_W, estimate.omega_WB_B, estimate.dq])
        h = pin.computeCentroidalMomentum(self._model, self._data, q, v).vector / self._mass
        return State(h, np.array(estimate.p_WB), R, estimate.q.reshape(4, 3))

    def _acting(self, t: float, reference: MotionReference) -> np.ndarray:
        """(4, 3) mean forces from t until the new plan begins [N]; without a plan the feet share the weight.

        The last plan begins after t: up to there it is the one before it that acts. Forces of a foot that has left
        the ground since then count too: until the new policy comes `wbc` asks their wrench of the other feet.
        """
        if self._iterate is None:
            stance = is_grounded(reference.leg_status)
            force = np.zeros((4, 3))
            force[stance, 2] = self._mass * GRAVITY / max(int(stance.sum()), 1)
            return force
        share = min(max((self._t - t) / self.deployment.mpc.lead_s, 0.0), 1.0)
        return share * self._force_before_W + (1.0 - share) * self._planned(self._iterate, max(t, self._t))

    def _planned(self, plan: Trajectory, t: float) -> np.ndarray:
        """(4, 3) forces of the last plan at time t [N]."""
        step = min(max(int((t - self._t) / self._dt), 0), self._problem.N - 1)
        return plan.force_W[step]

    def _predict(self, now: State, estimate: StateEstimate, force_W: np.ndarray, dt: float) -> State:
        """The state after `dt` [s] under the forces that act meanwhile: one explicit step of eq. (1c)."""
        arm = estimate.p_WF - self._data.com[0]
        h = now.h.copy()
        h[:3] += dt / self._mass * force_W.sum(axis=0)
        h[2] -= dt * GRAVITY
        h[3:] += dt / self._mass * (skew(arm) @ force_W[..., None])[..., 0].sum(axis=0)
        R = now.R_WB @ exp_rotation(dt * estimate.omega_WB_B)
        return State(h, now.p_WB + dt * estimate.v_WB_W, R, now.q + dt * estimate.dq.reshape(4, 3))

    def _warm_start(self, nodes: NodeReference, t: float) -> Trajectory:
        """The last trajectory at the new nodes; where a leg's contact has changed, the reference's input."""
        old, old_contact = self._iterate, self._contact
        if old is None or old_contact is None:
            return self._problem.cold_start(nodes)
        N = self._problem.N
        position = np.minimum(np.arange(N + 1) + max((t - self._t) / self._dt, 0.0), N)
        low = np.minimum(position.astype(int), N - 1)
        share = position - low
        held = low[:N]

        def between(values: np.ndarray) -> np.ndarray:
            before = values[low]
            weight = share.reshape(-1, *(1,) * (values.ndim - 1))
            return before + weight * (values[low + 1] - before)

        R_before = old.R_WB[low]
        turn = log_rotations(R_before.swapaxes(1, 2) @ old.R_WB[low + 1])
        same = (old_contact[held] == nodes.contact[:N])[..., None]
        contact = nodes.contact[:N, :, None]
        cold_velocity = np.where(contact, 0.0, nodes.v_WF[:N])
        return replace(
            old,
            h=between(old.h),
            p_WB=between(old.p_WB),
            R_WB=R_before @ exp_rotations(share[:, None] * turn),
            q=between(old.q),
            force_W=np.where(same, old.force_W[held], contact * nodes.force_W[:N]),
            foot_velocity_W=np.where(same, old.foot_velocity_W[held], cold_velocity),
            v=old.v[held],
        )

    def _publish(self, t: float, nodes: NodeReference, step: Step, watch: _Stopwatch, outbox: Outbox) -> None:
        iterate, N = step.iterate, self._problem.N
        u = np.concatenate([iterate.force_W.reshape(N, 12), iterate.v[:, 6:]], axis=1)
        # What the old iterate violates: the terms are evaluated where the linearisation was made.
        violations = self._problem.violations(step.nodes)
        x = policy_states(iterate)
        watch.mark("policy")
        policy = Policy(
            t=t,
            valid=True,
            dt=self._dt,
            x=x,
            u=u,
            v=np.concatenate([iterate.v, iterate.v[-1:]]),
            contact=nodes.contact,
            solver="ok",
            constraint=tuple(violations),
            violation=np.array(list(violations.values())),
            stage=tuple(watch.stage_ms),
            stage_ms=np.array(list(watch.stage_ms.values())),
        )
        outbox.publish("mpc/policy", policy)
