"""The trajectory optimisation's process: a stride and its GRF envelope on request (OPT of Fig. 6)."""

from __future__ import annotations

from dataclasses import replace
from time import perf_counter
from typing import ClassVar

import numpy as np

from surefoot.bus.messages import Plan, PlanRequest, StateEstimate
from surefoot.components.component import Component, Inbox, Outbox
from surefoot.components.memory import Memory
from surefoot.components.ocp.problem import Problem, State, policy_states
from surefoot.components.ocp.riccati import SolverFailed
from surefoot.components.robot_model.rotation import matrix_of, rpy_of
from surefoot.components.trajopt.envelope import grf_envelope
from surefoot.components.trajopt.stride import Stride


class Trajopt(Component):
    """Optimises eqs. (1)-(4) over one stride, from the reference and at rest; a failure is named in the plan."""

    name: ClassVar[str] = "trajopt"
    inputs: ClassVar[tuple[str, ...]] = ("trajopt/request", "state/estimate", "operator/tuning")
    outputs: ClassVar[tuple[str, ...]] = ("trajopt/plan",)
    memory: ClassVar[Memory] = Memory("trouble")

    def set_up(self) -> None:
        deployment, settings = self.deployment, self.deployment.trajopt
        robot = deployment.load_robot()
        rounder = replace(deployment.ocp, cone_regularisation_n2=settings.cone_regularisation_n2)
        self._settings = settings
        self._problem = Problem(rounder, robot, settings.intervals)
        self._stride = Stride(robot, settings, deployment.fsm)

    def step(self, t: float, inbox: Inbox, outbox: Outbox) -> None:
        self.heed_tuning(inbox)
        for request in inbox.new("trajopt/request"):
            estimate = inbox.fresh("state/estimate", t)
            if estimate is None:
                why = "no fresh state/estimate: is the estimator running?"
                plan = Plan(t=t, id=request.id, status=why)
            else:
                plan = self._plan(t, request, estimate)
            self.trouble = "" if plan.status == "ok" else plan.status
            outbox.publish("trajopt/plan", plan)

    def _plan(self, t: float, request: PlanRequest, estimate: StateEstimate) -> Plan:
        begun = perf_counter()
        R_WB = matrix_of(estimate.quat_WB)
        reference = self._stride.sample(request, np.concatenate([estimate.p_WB, rpy_of(R_WB)]))
        measured = State(np.zeros(6), estimate.p_WB, R_WB, estimate.q.reshape(4, 3))
        settings = self._settings
        try:
            step, iterations = self._problem.converge(reference, measured, settings.iterations, settings.tolerance)
        except SolverFailed as error:
            return Plan(t=t, id=request.id, status=str(error))
        iterate, N = step.iterate, self._problem.N
        leg = int(request.leg_order[0])
        start = self._stride.touch_down(0) + settings.envelope_trim_s
        end = reference.t[-1] - settings.envelope_trim_s
        envelope = grf_envelope(reference.t[:N], iterate.force_W[:, leg], start, end, request.normal_W)
        return Plan(
            t=t,
            valid=True,
            id=request.id,
            status="ok",
            footholds_WF=self._footholds(step.nodes.linear.p_WF, request),
            envelope_W=settings.envelope_scale * envelope,
            dt=settings.interval_s,
            x=policy_states(iterate),
            u=np.concatenate([iterate.force_W.reshape(N, 12), iterate.v[:, 6:]], axis=1),
            iterations=iterations,
            solve_ms=1e3 * (perf_counter() - begun),
        )

    @staticmethod
    def _footholds(p_WF: np.ndarray, request: PlanRequest) -> np.ndarray:
        """Where the optimised feet stand at the stride's end; blind, the targets themselves (Sec. II-B.5).

        A region bounds where a foot stands in the plane. Its height is the target's: that of the patch of ground.
        """
        adapted = p_WF[-1].copy()
        adapted[:, 2] = request.target_WF[:, 2]
        return np.where(request.region_active[:, None], adapted, request.target_WF)
