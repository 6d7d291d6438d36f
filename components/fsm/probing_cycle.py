"""The stepping and probing of Fig. 6: from a target pose to a foothold that has borne its load, leg by leg."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace

import numpy as np

from surefoot.bus.messages import FootholdRegions, MotionReference, Plan
from surefoot.components.fsm.alarms import Alarms
from surefoot.components.fsm.arrow import Arrow, End, Fork
from surefoot.components.fsm.balance import Balance
from surefoot.components.fsm.certificates import Certificates
from surefoot.components.fsm.course import Course
from surefoot.components.fsm.foothold_planner import FootholdPlanner
from surefoot.components.fsm.leg_turn import LegTurn
from surefoot.components.fsm.motion import Motion
from surefoot.components.fsm.observation import Observation
from surefoot.components.fsm.phases import Phases
from surefoot.components.fsm.questions import Questions
from surefoot.components.fsm.stance_watch import StanceWatch
from surefoot.components.fsm.state import State
from surefoot.components.memory import Memory
from surefoot.config.fsm import Fsm
from surefoot.config.robot import LEGS, Robot

_STAND_S = 1.0
"""Time to bring the base over the middle of the feet."""


class ProbingCycle:
    """Takes the robot in one direction, one probed foothold after the other.

    Attributes:
        state: of Fig. 6.
        reason: why it was entered.
        motion: what is asked of the MPC and the whole-body controller.
        finished: every foot has advanced by the goal.
    """

    memory = Memory(
        "reason",
        "finished",
        "_entered",
        state=State,
        motion=Motion,
        _turn=LegTurn,
        _watch=StanceWatch,
        _certificates=Certificates,
        _course=Course,
        _balance=Balance,
        _phases=Phases,
    )

    def __init__(self, robot: Robot, settings: Fsm, report: Callable[..., None]):
        """`report(kind, reason, **figures)` is called for every event."""
        self._settings, self._report = settings, report
        self.motion, self._turn = motion, turn = Motion(settings), LegTurn()
        self._planner = planner = FootholdPlanner(robot, settings)
        self._watch, self._certificates = watch, certificates = StanceWatch(), Certificates(settings)
        self._course, self._balance = course, balance = Course(planner, settings), Balance(settings)
        event = self._event
        self._phases = Phases(robot, settings, planner, course, watch, balance, certificates, motion, turn, event)
        self._alarms = Alarms(settings, planner, course, watch, balance, motion, turn, event)
        self.state, self.reason, self._entered = State.STOPPED, "", 0.0
        self.finished = False

    @property
    def reference(self) -> MotionReference:
        """The motion asked for now."""
        return self.motion.reference

    @property
    def questions(self) -> Questions:
        """What it asks of the map and of the trajectory optimisation."""
        return self._phases.planning.questions

    @property
    def certified_n(self) -> np.ndarray:
        """(4,) largest normal force each foothold has really borne [N]."""
        return self._certificates.held_n

    @property
    def displaced_m(self) -> np.ndarray:
        """(4,) how far the foot had moved under it from where it touched down [m]."""
        return self._certificates.displaced_m

    @property
    def counters(self) -> dict[str, int]:
        """Candidate and around point of the moment, for events."""
        return {"candidate": self._turn.candidate, "around": self._turn.around}

    def waited_s(self, now: Observation) -> float:
        """How long the present state has lasted [s]."""
        return now.t - self._entered

    # What the owner calls -------------------------------------------------------------------------------

    def stand_up(self, now: Observation) -> None:
        """The robot has come to stand: trust the ground under its feet."""
        for leg in range(4):
            self.motion.trust(leg)
        self._watch.begin(now.estimate.p_WF)
        self._certificates.void()
        self.stand(now, "standing")

    def stand(self, now: Observation, reason: str) -> None:
        """Balance on four feet with the base in their middle; a foot on bad ground is leant off."""
        feet, yaw, normal = now.estimate.p_WF, now.rpy[2], now.estimate.normal_W
        middle = self._planner.pose(self._planner.centre(feet, yaw), feet, normal, yaw)
        self.motion.stand(now, middle, _STAND_S)
        for leg in map(int, np.flatnonzero(~self.motion.grounded)):
            lean = self._planner.support_pose(leg, feet[leg], feet, normal, yaw, now.com_B, np.zeros(3))
            if lean is not None:
                self.motion.lean_off(leg, now, lean, _STAND_S)
        self._turn.end()
        self._enter(State.STOPPED, now, reason)

    def walk(self, now: Observation, direction_B: np.ndarray, name: str) -> None:
        """Start in a direction of the base frame (2,); a leg that does not stand safely goes first."""
        self._phases.planning.walk(now, direction_B)
        self.finished = False
        self._enter(State.PRE_OPT, now, f"commanded {name}")

    def stop(self, now: Observation, reason: str) -> None:
        """Come to rest: at once on four trusted feet, otherwise after the leg is back at its safe foothold."""
        if self.state == State.RETURN_SAFE:
            self._turn.halt = reason
        elif self.motion.in_air or self.state == State.PROBE:
            self._turn.halt = reason
            self._follow(Arrow(State.RETURN_SAFE, reason), now)
        elif self.state != State.STOPPED:
            self.motion.plant(now)
            self.stand(now, reason)

    @property
    def under_way(self) -> bool:
        """A leg is in the air, presses, or goes back: it has a step to finish."""
        return self.motion.in_air or self.state in (State.PROBE, State.RETURN_SAFE)

    @property
    def ends(self) -> str:
        """Why the robot is to rest when the step is over, or ""."""
        return self._turn.halt

    @property
    def leg_name(self) -> str:
        """Of the leg under way."""
        return LEGS[self._turn.leg]

    @property
    def stuck(self) -> bool:
        """The walk has ended on four feet because a leg has found no foothold."""
        return self.state == State.STOPPED and not self.motion.in_air and self._course.stuck

    def halt(self, now: Observation, reason: str) -> None:
        """Come to rest on four feet: when the step is over, or at once where no leg has left the ground."""
        if self.under_way:
            self._turn.halt = reason
            return
        if self.state in (State.SEND, State.OPT, State.MOVE):
            self._course.give_back(self._turn.leg)
        self.motion.plant(now)
        self.stand(now, reason)

    def rest(self, now: Observation, reason: str) -> None:
        """Go on resting, for another reason."""
        self._enter(State.STOPPED, now, reason)

    def go_on(self, now: Observation, reason: str, halt: str = "") -> None:
        """The walk goes on with the next leg; with `halt` it is to rest after that one, for this reason."""
        self._enter(State.PRE_OPT, now, reason)
        self._turn.halt = halt

    def keep_walking(self) -> None:
        """It is not to rest after the step."""
        self._turn.halt = ""

    def try_again(self, now: Observation, reason: str) -> None:
        """The legs that found no foothold try once more."""
        self._course.try_again()
        self._enter(State.PRE_OPT, now, reason)

    def keeps_down(self, now: Observation) -> str:
        """Why the foot that presses must not be lifted now, or ""."""
        return self._phases.keeps_down(now)

    def skip(self, now: Observation) -> None:
        """Give up the foothold of the moment for the next candidate."""
        self._follow(self._phases.skip(self.state, now), now)

    def press_again(self, now: Observation) -> None:
        """The foot that presses does so once more, from the first force."""
        self._follow(self._phases.probing.press_again(now), now)

    @property
    def press_ends(self) -> str:
        """Why the press is being broken off, or ""."""
        return self._phases.probing.ends

    def regions(self, answer: FootholdRegions, now: Observation) -> None:
        """The map's answer to a foothold request."""
        if self.state == State.SEND and self.questions.answered_by(answer):
            self._follow(self._phases.planning.regions(answer, now), now)

    def plan(self, plan: Plan, now: Observation) -> None:
        """The trajectory optimisation's answer."""
        if self.state == State.OPT and self.questions.answered_by(plan):
            self._follow(self._phases.planning.plan(plan), now)

    def step(self, now: Observation) -> None:
        """Advance by one tick."""
        self._watch.update(now.estimate.p_WF, self.motion.trusted)
        self._watch.load(now.estimate.force_W @ now.estimate.normal_W, self.motion.bearing)
        if self._settings.probing:
            self._heed_alarms(now)
        self._follow(self._phases.advance(self.state, self.waited_s(now), now), now)

    def message(self, t: float) -> MotionReference:
        """The reference to publish at time t."""
        turn, presses = self._turn, self.state == State.PROBE
        # While a foot presses there is no cap: the foot across bears that press and (W m)/h more, whatever it is
        # certified for.
        caps_n = np.zeros(4) if presses else self._certificates.caps_n(self.motion.trusted)
        return replace(
            self.reference,
            t=t,
            valid=True,
            state=str(self.state),
            reason=self.reason,
            leg=turn.leg,
            candidate=turn.candidate,
            around=turn.around,
            force_index=self._phases.probing.force_index if presses else -1,
            finished=self.finished,
            force_max_n=caps_n,
        )

    # What happens in a tick -----------------------------------------------------------------------------

    def _heed_alarms(self, now: Observation) -> None:
        alarms = self._alarms
        for leg in alarms.late_collapses(self.state, now):
            self._follow(alarms.gave_way(leg, self.state, now), now)
        self._follow(alarms.off_balance(self.state, now), now)
        if alarms.can_free(self.state, now):
            self._phases.retreat.begin_leg_up(now, freed=True)
            self._enter(State.LEG_UP, now, f"{LEGS[self._turn.leg]} leaves the ground that gave way")

    def _follow(self, arrow: Arrow | None, now: Observation) -> None:
        """Along the arrows of Fig. 6 to the state that they end in."""
        if arrow is None:
            return
        to, why = arrow.to, arrow.why
        match to:
            case Fork():
                self._follow(self._phases.decide(to, why, now), now)
            case End.LEAN:
                self.stand(now, why)
            case End.NO_LEG:
                self.finished = self._phases.planning.arrived
                self.stand(now, why)
                self._report("stopped", why)
            case State.STOPPED:
                self._rest(now, why)
            case State.PRE_OPT if self._turn.halt:
                self._rest(now, self._turn.halt)
            case State():
                self._phases.begin(to, why, now)
                self._enter(to, now, why)

    def _rest(self, now: Observation, reason: str) -> None:
        """STOPPED until a new direction is commanded: on four feet, or on three with the leg in the air."""
        if self.motion.in_air:
            self._turn.rest()
            self._enter(State.STOPPED, now, reason)
        else:
            self.stand(now, reason)
        self._report("stopped", reason)

    def _enter(self, state: State, now: Observation, reason: str) -> None:
        self.state, self.reason, self._entered = state, reason, now.t
        self._report("transition", reason, leg=self._turn.leg)

    def _event(self, kind: str, reason: str, p_WF: np.ndarray, **figures) -> None:
        """An event of the leg whose turn it is, unless `figures` name another, with its foot's place (3,)."""
        self._report(kind, reason, **({"leg": self._turn.leg, "p_WF": p_WF.copy()} | figures))
