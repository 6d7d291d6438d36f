"""A robot that does at once what the reference asks: the probing cycle alone, without physics.

The base and a swinging foot are where the reference wants them, a foot stops on the ground it meets, a
pressing foot presses with the force asked. The ground gives way where a test says so.
"""

import numpy as np

from surefoot.bus.messages import FootholdRegions, LegStatus, Plan, StateEstimate
from surefoot.components.fsm.foothold_planner import FootholdPlanner
from surefoot.components.fsm.observation import Observation
from surefoot.components.fsm.probing_cycle import ProbingCycle
from surefoot.components.gait.swing_spline import SwingSpline
from surefoot.config.fsm import Fsm
from surefoot.config.robot import load_robot

TICK = 0.004
UP = np.array([0.0, 0.0, 1.0])
ROBOT = load_robot("aliengo")
IN_AIR = (LegStatus.SWING, LegStatus.LANDING)
FOOT_Z = 0.0265


class Puppet:
    """Drives a `ProbingCycle`; `events` holds what it reported.

    Attributes:
        ground_z: (4,) height at which each leg's foot meets ground when it comes down [m].
        sunk: (4,) how far the ground under each foot has given way [m].
        load_n: (4,) what each foot bears where it stands and does not press [N].
        tilt: roll that the estimate claims [rad].
        weak: share of the asked force that the ground really takes.
        map: what a request's answer says otherwise than "blind": fields of `FootholdRegions`.
        placed: where a plan's footholds (4, 3) are, from its request.
        unanswered: of "regions" and "plan", the questions that nobody answers.
    """

    def __init__(self, settings=None, forward=True):
        self.settings = settings or Fsm(probe_around=False)
        planner = FootholdPlanner(ROBOT, self.settings)
        self.feet = planner.nominal_BF.copy()
        self.feet[:, 2] = FOOT_Z
        self.pose = planner.pose(np.zeros(2), self.feet, UP, 0.0)
        self.ground_z, self.sunk, self.load_n = np.full(4, FOOT_Z), np.zeros(4), np.full(4, 60.0)
        self.tilt, self.weak, self.t = 0.0, 1.0, 0.0
        self.events, self.unanswered = [], ()
        self.map = lambda request: {}
        self.placed = lambda request: request.target_WF
        self.cycle = ProbingCycle(ROBOT, self.settings, self._report)
        self.cycle.stand_up(self.observe())
        if forward:
            self.cycle.walk(self.observe(), np.array([1.0, 0.0]), "forward")

    def _report(self, kind, reason, **figures):
        self.events.append((kind, reason, figures, str(self.cycle.state)))

    def kinds(self, kind):
        return [event for event in self.events if event[0] == kind]

    @property
    def status(self):
        return [LegStatus(int(status)) for status in self.cycle.reference.leg_status]

    def observe(self):
        reference = self.cycle.reference if hasattr(self, "cycle") else None
        feet = self.feet - np.outer(self.sunk, UP)
        contact, force = np.ones(4, bool), np.outer(self.load_n, UP)
        if reference is not None:
            for leg in np.flatnonzero(np.isin(reference.leg_status, IN_AIR)):
                contact[leg] = feet[leg, 2] <= self.ground_z[leg] - self.sunk[leg] + 1e-6
                force[leg] = contact[leg] * 30.0 * UP
            if reference.probe_leg >= 0:
                index = int((self.t - reference.probe_t0) / reference.probe_dwell_s) + 1
                asked = reference.probe_force_W[np.clip(index, 0, len(reference.probe_force_W) - 1)]
                force[reference.probe_leg] = self.weak * asked
        estimate = StateEstimate(
            t=self.t, valid=True, p_WB=self.pose[:3], p_WF=feet, normal_W=UP, contact=contact, force_W=force
        )
        return Observation(self.t, estimate, self.pose[:3].copy(), self.pose[3:] + [self.tilt, 0.0, 0.0])

    def tick(self):
        self.t += TICK
        reference = self.cycle.reference
        share = np.clip((self.t - reference.base_t0) / max(reference.base_t1 - reference.base_t0, 1e-6), 0.0, 1.0)
        self.pose = reference.base_from + share * (reference.base_to - reference.base_from)
        for leg in np.flatnonzero(np.isin(reference.leg_status, IN_AIR)):
            self.feet[leg] = SwingSpline(reference).sample(np.array([self.t]))[0][0]
            self.feet[leg, 2] = max(self.feet[leg, 2], self.ground_z[leg])
            if self.feet[leg, 2] > self.ground_z[leg] + 0.01:
                self.sunk[leg] = 0.0
        now = self.observe()
        self._answer(now)
        self.step(now)

    def step(self, now):
        """One tick of the cycle alone."""
        self.cycle.step(now)

    def _answer(self, now):
        questions = self.cycle.questions
        if questions.foothold_request is not None and "regions" not in self.unanswered:
            request, questions.foothold_request = questions.foothold_request, None
            blind = {"foothold_WF": request.target_WF, "safe": np.ones(4, bool)}
            figures = blind | self.map(request)
            self.cycle.regions(FootholdRegions(t=self.t, valid=True, id=request.id, **figures), now)
        if questions.plan_request is not None and "plan" not in self.unanswered:
            request, questions.plan_request = questions.plan_request, None
            envelope = np.linspace(60.0, 100.0, 6)[:, None] * UP
            plan = Plan(
                t=self.t,
                valid=True,
                id=request.id,
                status="ok",
                footholds_WF=self.placed(request),
                envelope_W=envelope,
            )
            self.cycle.plan(plan, now)

    def run(self, seconds, until=None):
        """Tick until `until()`, or for some seconds; whether it came true."""
        for _ in range(round(seconds / TICK)):
            self.tick()
            if until is not None and until():
                return True
        return False

    def reach(self, state, seconds=10.0):
        assert self.run(seconds, lambda: self.cycle.state == state), f"{self.cycle.state}: {self.cycle.reason}"
