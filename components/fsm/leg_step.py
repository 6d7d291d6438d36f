"""MOVE and DETECT_CONTACT of Fig. 6 (Sec. II-D.4): the base over three feet, then the foot to its foothold."""

from __future__ import annotations

from collections.abc import Callable

from surefoot.components.fsm.arrow import Arrow, Fork
from surefoot.components.fsm.balance import Balance
from surefoot.components.fsm.course import Course
from surefoot.components.fsm.leg_swing import LegSwing
from surefoot.components.fsm.leg_turn import LegTurn
from surefoot.components.fsm.motion import Motion
from surefoot.components.fsm.observation import Observation
from surefoot.components.fsm.state import State
from surefoot.config.fsm import Fsm
from surefoot.config.robot import LEGS


class LegStep:
    """The step of the leg whose turn it is."""

    def __init__(
        self,
        settings: Fsm,
        course: Course,
        balance: Balance,
        swing: LegSwing,
        motion: Motion,
        turn: LegTurn,
        event: Callable[..., None],
    ):
        """`event(kind, reason, p_WF, **figures)` reports what happens to a foot."""
        self._settings, self._course, self._balance, self._swing = settings, course, balance, swing
        self._motion, self._turn, self._event = motion, turn, event

    def begin_move(self, now: Observation) -> None:
        """The base goes inside the triangle of the other three; the swing waits for it."""
        settings, turn = self._settings, self._turn
        duration = self._motion.time_to(turn.support_pose, now)
        if not self._motion.in_air:
            duration = max(settings.shift_s, duration)
            self._swing.plan(now.t + duration, turn.foothold_W, now, turn.region)
        self._motion.shift_base(now, turn.support_pose, duration)
        self._balance.begin_shift()

    def move(self, now: Observation, waited_s: float) -> Arrow | None:
        """MOVE: lift off when the base is at rest where it can stand on three feet."""
        settings, motion, turn = self._settings, self._motion, self._turn
        reference = motion.reference
        if waited_s > settings.shift_timeout_s + reference.base_t1 - reference.base_t0:
            why = "the base did not come to rest inside the triangle"
            self._event("rejected", why, turn.foothold_W)
            return Arrow(Fork.UNFIT, why)
        ready = self._balance.ready(now, reference, turn.leg)
        if motion.in_air:
            if ready and now.t >= reference.base_t1:
                self._swing.plan(now.t, turn.foothold_W, now, turn.region)
                return self._lift_off(now)
        elif ready and now.t >= reference.swing_t0:
            return self._lift_off(now)
        elif not ready:
            motion.postpone(now, settings.swing_s)
        return None

    def detect_contact(self, now: Observation) -> Arrow | None:
        """DETECT_CONTACT, also of PROBE_AROUND: contact, or the next alternative where there is no ground."""
        if self._swing.landed(now):
            self._swing.touched(now)
            return Arrow(Fork.CONTACT)
        why = self._swing.search_below(now)
        if not why:
            return None
        self._event("rejected", why, now.estimate.p_WF[self._turn.leg])
        return Arrow(State.LEG_UP, why)

    def _lift_off(self, now: Observation) -> Arrow:
        settings, motion = self._settings, self._motion
        if settings.base_reference == "stride":
            # Fig. 9: the base goes on along its stride and does not wait until the probing is over.
            target = self._course.base_target(now.estimate.p_WF, motion.reference.normal_W)
            motion.shift_base(now, target, settings.stride_s)
        motion.lift_off(now, settings.swing_s)
        return Arrow(State.DETECT_CONTACT, f"{LEGS[self._turn.leg]} lifts off")
