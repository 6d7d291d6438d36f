"""Fig. 6: the phases of a leg's turn, and the arrows between them."""

from __future__ import annotations

from collections.abc import Callable

from surefoot.components.fsm.arrow import Arrow, Fork
from surefoot.components.fsm.balance import Balance
from surefoot.components.fsm.certificates import Certificates
from surefoot.components.fsm.course import Course
from surefoot.components.fsm.foothold_planner import FootholdPlanner
from surefoot.components.fsm.leg_step import LegStep
from surefoot.components.fsm.leg_swing import LegSwing
from surefoot.components.fsm.leg_turn import LegTurn
from surefoot.components.fsm.motion import Motion
from surefoot.components.fsm.observation import Observation
from surefoot.components.fsm.planning import Planning
from surefoot.components.fsm.probing import SKIPPED, Probing
from surefoot.components.fsm.retreat import Retreat
from surefoot.components.fsm.stance_watch import StanceWatch
from surefoot.components.fsm.state import State
from surefoot.components.memory import Memory
from surefoot.config.fsm import Fsm
from surefoot.config.robot import LEGS, Robot


class Phases:
    """No phase knows another: each does its part and says what follows; whose part that is, is told here.

    Attributes:
        planning: PRE_OPT, SEND, OPT.
        step: MOVE, DETECT_CONTACT.
        probing: PROBE, PROBE_AROUND.
        retreat: LEG_UP, RETURN_SAFE.
    """

    memory = Memory(planning=Planning, probing=Probing, retreat=Retreat, _swing=LegSwing)

    def __init__(
        self,
        robot: Robot,
        settings: Fsm,
        planner: FootholdPlanner,
        course: Course,
        watch: StanceWatch,
        balance: Balance,
        certificates: Certificates,
        motion: Motion,
        turn: LegTurn,
        event: Callable[..., None],
    ):
        """`event(kind, reason, p_WF, **figures)` reports what happens to the leg whose turn it is."""
        self._balance, self._motion, self._turn, self._event = balance, motion, turn, event
        self._swing = swing = LegSwing(settings, planner, course, watch, motion, turn, event)
        self.planning = Planning(robot, settings, planner, course, watch, certificates, motion, turn, event)
        self.step = LegStep(settings, course, balance, swing, motion, turn, event)
        self.probing = Probing(robot, settings, course, watch, certificates, swing, motion, turn, event)
        self.retreat = Retreat(settings, planner, course, watch, swing, motion, turn)

    def advance(self, state: State, waited_s: float, now: Observation) -> Arrow | None:
        """What follows on a state that was entered some time ago [s]; None while it lasts."""
        match state:
            case State.PRE_OPT:
                return self.planning.pre_opt(now)
            case State.SEND:
                return self.planning.send(waited_s)
            case State.OPT:
                return self.planning.opt(waited_s)
            case State.MOVE:
                return self.step.move(now, waited_s)
            case State.DETECT_CONTACT | State.PROBE_AROUND:
                return self.step.detect_contact(now)
            case State.PROBE:
                return self.probing.probe(now)
            case State.LEG_UP:
                return self.retreat.leg_up(now)
            case State.RETURN_SAFE:
                return self.retreat.return_safe(now)
            case State.STOPPED:
                return None

    def skip(self, state: State, now: Observation) -> Arrow | None:
        """Give up the foothold of the moment; None: the foot is unloaded first."""
        match state:
            case State.SEND | State.OPT | State.MOVE:
                return self.planning.skip(state, SKIPPED)
            case State.PROBE:
                self.probing.skip(now)
                return None
            case _:
                self._event("rejected", SKIPPED, now.estimate.p_WF[self._turn.leg])
                return Arrow(State.LEG_UP, SKIPPED)

    def keeps_down(self, now: Observation) -> str:
        """Why the foot that presses must not be lifted now, or "": the other three have to carry the robot."""
        leg, motion = self._turn.leg, self._motion
        if self.probing.ends:
            return f"the press ends already: {self.probing.ends}"
        weak = [LEGS[other] for other in range(4) if other != leg and not motion.trusted[other]]
        if weak:
            return f"{', '.join(weak)} does not stand on ground that has borne: {LEGS[leg]} stays down"
        if not self._balance.inside(now, motion.reference, leg):
            return f"the base is not inside the other three feet: {LEGS[leg]} stays down; say it again"
        return ""

    def decide(self, fork: Fork, why: str, now: Observation) -> Arrow:
        """Which way from a fork, come to for a reason."""
        match fork:
            case Fork.CONTACT:
                return self.probing.contact(now)
            case Fork.BROKEN_OFF:
                return self.probing.stay(now, why)
            case Fork.UNFIT:
                return self.planning.next_candidate(now)
            case Fork.BACK:
                return self.retreat.back(now, why)

    def begin(self, state: State, why: str, now: Observation) -> None:
        """Set about a state that several phases lead to; the others have been begun by the phase they are of."""
        match state:
            case State.SEND:
                self.planning.ask(now)
            case State.MOVE:
                self.step.begin_move(now)
            case State.LEG_UP:
                self.retreat.begin_leg_up(now)
            case State.RETURN_SAFE:
                self.retreat.begin_return(now, why)
