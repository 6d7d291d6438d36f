"""PRE_OPT, SEND, OPT of Fig. 6 (Secs. II-D.1 to II-D.3): a leg, and a foothold for map, reach and plan alike."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np

from surefoot.bus.messages import FootholdRegions, Plan
from surefoot.components.fsm.arrow import Arrow, End, Fork
from surefoot.components.fsm.certificates import Certificates
from surefoot.components.fsm.course import Course
from surefoot.components.fsm.foothold_planner import FootholdPlanner
from surefoot.components.fsm.leg_turn import LegTurn
from surefoot.components.fsm.motion import Motion
from surefoot.components.fsm.observation import Observation
from surefoot.components.fsm.questions import Questions
from surefoot.components.fsm.stance_watch import StanceWatch
from surefoot.components.fsm.state import State
from surefoot.components.memory import Memory
from surefoot.config.fsm import Fsm
from surefoot.config.robot import LEGS, Robot

_NO_FOOTHOLD = "no safe foothold among the alternatives"
_MAP_S, _PLAN_S = 1.0, 2.0  # an answer that takes longer is asked for again


class Planning:
    """Goes through a leg's candidates until one is worth a step.

    Attributes:
        questions: what it asks of the map and of the trajectory optimisation.
    """

    memory = Memory(questions=Questions)

    def __init__(
        self,
        robot: Robot,
        settings: Fsm,
        planner: FootholdPlanner,
        course: Course,
        watch: StanceWatch,
        certificates: Certificates,
        motion: Motion,
        turn: LegTurn,
        event: Callable[..., None],
    ):
        """`event(kind, reason, p_WF, **figures)` reports what becomes of a candidate."""
        self._settings, self._planner, self._course, self._watch = settings, planner, course, watch
        self._certificates, self._motion, self._turn, self._event = certificates, motion, turn, event
        self._same_place_m = 0.5 * robot.foot.radius
        self.questions = Questions()

    @property
    def arrived(self) -> bool:
        """Where no leg has a step to make, all have reached the goal: none has failed to find a foothold."""
        return not self._course.stuck

    def walk(self, now: Observation, direction_B: np.ndarray) -> None:
        """Start in a direction of the base frame (2,): a leg in the air first, then those that stand badly."""
        self._course.begin(self._footing(now), now.rpy[2], direction_B)
        if self._motion.in_air:
            self._course.put_first(self._turn.leg)
        for leg in np.flatnonzero(~self._motion.grounded):
            self._course.put_first(int(leg))

    def pre_opt(self, now: Observation) -> Arrow:
        """Target pose, footholds and alternatives of the next leg."""
        feet, normal = self._footing(now), now.estimate.normal_W
        leg = self._course.next_leg(feet, normal)
        if leg < 0:
            return Arrow(End.NO_LEG, _NO_FOOTHOLD if self._course.stuck else "every foot has reached the goal")
        targets = self._course.targets(feet, normal)
        self._turn.begin(leg, targets, self._course.candidates(targets[leg], feet, normal))
        self._motion.on_plane(now)
        return Arrow(State.SEND, f"{LEGS[leg]} is next")

    def ask(self, now: Observation) -> None:
        """SEND: ask the map for the safe regions around the targets."""
        turn = self._turn
        targets = turn.targets_W.copy()
        targets[turn.leg] = turn.candidates_W[turn.candidate]
        turn.targets_W = targets
        feet, normal = self._motion.reference.p_WF, self._motion.reference.normal_W
        base = self._course.base_target(feet, normal)
        self.questions.ask_regions(now.t, targets, normal, p_WF=self._feet_now(now), base_target=base)

    def send(self, waited_s: float) -> Arrow | None:
        """The map has not answered yet."""
        if waited_s <= _MAP_S:
            return None
        return Arrow(State.SEND, f"no answer on foothold/regions for {_MAP_S:g} s: asked again")

    def regions(self, answer: FootholdRegions, now: Observation) -> Arrow:
        """The map's answer: where it allows a step that the base can support, ask for a stride with it."""
        settings, turn, motion = self._settings, self._turn, self._motion
        leg, feet, normal = turn.leg, motion.reference.p_WF, motion.reference.normal_W
        turn.answer = answer
        foothold = answer.foothold_WF[leg]
        unfit = self._unfit(answer)
        if unfit:
            return self._reject(unfit, foothold)
        around = settings.around_radius_m if settings.probing and settings.probe_around else 0.0
        ahead = around * np.append(self._course.direction, 0.0)
        depth = 0.0 if answer.region_active[leg] else settings.depth_reserve_m  # a map knows how deep it is
        heading = self._course.heading
        pose = self._planner.support_pose(leg, foothold, feet, normal, heading, now.com_B, ahead, depth)
        if pose is None:
            return self._reject("out of reach at every base height", foothold)
        turn.support_pose = pose
        self.questions.ask_plan(
            now.t,
            answer,
            normal,
            leg_order=self._course.order_from(leg),
            p_WF=self._feet_now(now),
            lifted=motion.in_air,
            base_target=self._course.base_target(feet, normal),
            force_max_n=self._certificates.caps_n(motion.trusted),
        )
        turn.foothold_W = foothold.copy()
        return Arrow(State.OPT, "optimising the stride")

    def opt(self, waited_s: float) -> Arrow | None:
        """The trajectory optimisation has not answered yet."""
        if waited_s <= _PLAN_S:
            return None
        return Arrow(State.SEND, f"no answer on trajopt/plan for {_PLAN_S:g} s: asked again")

    def plan(self, plan: Plan) -> Arrow:
        """The trajectory optimisation's answer: the probing position and the forces that it must bear."""
        turn = self._turn
        if plan.status != "ok":
            return self._reject(f"no plan: {plan.status}", turn.foothold_W)
        turn.foothold_W = plan.footholds_WF[turn.leg].copy()
        # It may be anywhere in its region, as that of the last candidate.
        tried = turn.tried(turn.foothold_W, self._same_place_m)
        if tried:
            return self._reject(tried, turn.foothold_W)
        fixed, normal = self._settings.fixed_force_n, self._motion.reference.normal_W
        turn.envelope_W = np.tile(fixed * normal, (6, 1)) if fixed else plan.envelope_W
        return Arrow(State.MOVE, f"base shift for {LEGS[turn.leg]}")

    def next_candidate(self, now: Observation) -> Arrow:
        """The next alternative, or back to the last safe foothold when there is none."""
        turn, motion = self._turn, self._motion
        turn.candidate += 1
        turn.around = 0
        if not motion.in_air:
            motion.plant(now)  # the swing that was planned must not begin
        if turn.candidate < len(turn.candidates_W):
            return Arrow(State.SEND, f"alternative {turn.candidate} of {len(turn.candidates_W) - 1}")
        self._course.put_off(turn.leg)
        return Arrow(State.RETURN_SAFE if motion.in_air else Fork.BACK, _NO_FOOTHOLD)

    def skip(self, state: State, why: str) -> Arrow:
        """A candidate is given up before the foot has set off for it, or while it waits in the air."""
        turn = self._turn
        foothold_W = turn.candidates_W[turn.candidate] if state == State.SEND else turn.foothold_W
        turn.failed_W.append(foothold_W.copy())
        return self._reject(why, foothold_W)

    def _unfit(self, answer: FootholdRegions) -> str:
        """Why the answer's foothold is not worth a step, or "": the map forbids it, or it has been tried."""
        leg = self._turn.leg
        if not answer.safe[leg]:
            return answer.reasons[leg] if answer.reasons else "the map knows no safe cell near it"
        return self._turn.tried(answer.foothold_WF[leg], self._same_place_m)

    def _reject(self, why: str, foothold_W: np.ndarray) -> Arrow:
        self._event("rejected", why, foothold_W)
        return Arrow(Fork.UNFIT, why)

    def _footing(self, now: Observation) -> np.ndarray:
        """(4, 3) the feet, with one that is in the air at its safe foothold."""
        feet = now.estimate.p_WF.copy()
        if self._motion.in_air:
            feet[self._turn.leg] = self._watch.safe(self._turn.leg)
        return feet

    def _feet_now(self, now: Observation) -> np.ndarray:
        """(4, 3) where the plan starts from: the feet that stand, and the one in the air where it is."""
        feet = self._motion.reference.p_WF.copy()
        if self._motion.in_air:
            feet[self._turn.leg] = now.estimate.p_WF[self._turn.leg]
        return feet
