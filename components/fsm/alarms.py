"""What ends a step from outside: a stance foot whose ground gives way, a base that loses its balance."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np

from surefoot.components.fsm.arrow import Arrow, End, Fork
from surefoot.components.fsm.balance import Balance
from surefoot.components.fsm.course import Course
from surefoot.components.fsm.foothold_planner import FootholdPlanner
from surefoot.components.fsm.leg_turn import LegTurn
from surefoot.components.fsm.motion import Motion
from surefoot.components.fsm.observation import Observation
from surefoot.components.fsm.stance_watch import StanceWatch
from surefoot.components.fsm.state import State
from surefoot.config.fsm import Fsm
from surefoot.config.robot import LEGS


class Alarms:
    """Watches stance feet and balance in every state."""

    def __init__(
        self,
        settings: Fsm,
        planner: FootholdPlanner,
        course: Course,
        watch: StanceWatch,
        balance: Balance,
        motion: Motion,
        turn: LegTurn,
        event: Callable[..., None],
    ):
        """`event(kind, reason, p_WF, **figures)` reports an alarm."""
        self._settings, self._planner, self._course, self._watch = settings, planner, course, watch
        self._balance, self._motion, self._turn, self._event = balance, motion, turn, event

    def late_collapses(self, state: State, now: Observation) -> list[int]:
        """A foot that sinks or slips after it was trusted is a collapse too: it is the next to be moved."""
        watched, leg = self._motion.bearing, self._turn.leg
        if state in (State.PROBE, State.RETURN_SAFE) and leg >= 0:
            watched[leg] = False  # PROBE judges it, or it is on its way
        moved = self._watch.displacement(now.estimate.p_WF)
        return [int(leg) for leg in np.flatnonzero(watched & (moved > self._settings.collapse_m))]

    def gave_way(self, leg: int, state: State, now: Observation) -> Arrow | None:
        """What a leg that has collapsed late means for the one whose turn it is."""
        motion, foot = self._motion, now.estimate.p_WF[leg]
        moved = float(self._watch.displacement(now.estimate.p_WF)[leg])
        why = f"{LEGS[leg]} moved {1e2 * moved:.1f} cm after it was accepted"
        borne_n = float(self._watch.borne_n[leg])
        self._event("late_collapse", why, foot, leg=leg, displacement_m=moved, held_n=borne_n)
        self._watch.sunk[leg] |= motion.trusted[leg]
        motion.distrust(leg, now)
        self._course.put_first(leg)
        if state == State.RETURN_SAFE:
            return None
        if motion.in_air:
            if state == State.STOPPED:
                self._turn.halt = why
            return Arrow(State.RETURN_SAFE, why)
        if state == State.STOPPED:
            return Arrow(End.LEAN, why)
        if state == State.PROBE:
            # To lift this foot too would leave two; the base stays, as without the press little is left to bear.
            return Arrow(Fork.BROKEN_OFF, f"{LEGS[leg]} gave way under the press")
        motion.plant(now)
        self._leave(leg, now)
        return Arrow(State.PRE_OPT, why)

    def can_free(self, state: State, now: Observation) -> bool:
        """A foot on ground that gives way is lifted as soon as the others can carry, or when it carries nothing.

        Who goes on counting on a foot that hangs in a hole loses the balance that the others could keep.
        """
        leg, motion = self._turn.leg, self._motion
        if state not in (State.SEND, State.OPT, State.MOVE) or motion.in_air or not motion.sinking[leg]:
            return False
        return self._balance.inside(now, motion.reference, leg) or not now.estimate.contact[leg]

    def off_balance(self, state: State, now: Observation) -> Arrow | None:
        """A base that tilts or leaves the support triangle while a leg is moved ends the step."""
        motion, turn = self._motion, self._turn
        resting = state in (State.RETURN_SAFE, State.STOPPED)
        if state != State.PROBE and (resting or not motion.in_air):
            return None
        why = self._balance.lost(now, motion.reference, turn.leg)
        if not why:
            return None
        self._event("rejected", why, now.estimate.p_WF[turn.leg])
        if motion.in_air and turn.no_way_back:
            # It has just come from there. To look again and again would keep the base where it cannot stay.
            self._leave(turn.leg, now)
            return Arrow(State.STOPPED, f"{why}; {turn.no_way_back}")
        if motion.in_air:
            turn.halt = why
            return Arrow(State.RETURN_SAFE, why)
        motion.plant(now)
        return Arrow(State.STOPPED, why)

    def _leave(self, leg: int, now: Observation) -> None:
        """The base sets off over the other three feet without waiting for a plan."""
        feet, normal = now.estimate.p_WF, now.estimate.normal_W
        heading = self._course.heading
        pose = self._planner.support_pose(leg, feet[leg], feet, normal, heading, now.com_B, np.zeros(3))
        if pose is not None:
            self._motion.shift_base(now, pose, self._settings.shift_s)
