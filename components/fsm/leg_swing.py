"""A leg's way through the air: early contact, late contact, or no ground at all."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np

from surefoot.components.fsm.course import Course
from surefoot.components.fsm.foothold_planner import FootholdPlanner
from surefoot.components.fsm.leg_turn import LegTurn
from surefoot.components.fsm.motion import LAND_AHEAD_S, Motion, Region
from surefoot.components.fsm.observation import Observation
from surefoot.components.fsm.stance_watch import StanceWatch
from surefoot.components.gait.swing_spline import SwingSpline
from surefoot.components.memory import Memory
from surefoot.config.fsm import Fsm

_STOPPED_SHARE = 0.5
"""A swinging foot slower than this share of its planned velocity has been stopped by something."""


class LegSwing:
    """Swings of the leg whose turn it is: to a foothold, to a point around it, and back."""

    memory = Memory("_touch_z")

    def __init__(
        self,
        settings: Fsm,
        planner: FootholdPlanner,
        course: Course,
        watch: StanceWatch,
        motion: Motion,
        turn: LegTurn,
        event: Callable[..., None],
    ):
        """`event(kind, reason, p_WF, **figures)` reports what happens to a foot."""
        self._settings, self._planner, self._course, self._watch = settings, planner, course, watch
        self._motion, self._turn, self._event = motion, turn, event
        self._touch_z = 0.0

    def plan(self, start: float, to: np.ndarray, now: Observation, region: Region | None = None) -> None:
        """Lift off at a time for a foothold (3,), inside a region where there is one."""
        settings = self._settings
        self._motion.plan_swing(self._turn.leg, start, to, now, settings.swing_s, settings.swing_height_m, region)
        self._touch_z = float(to[2])

    def plan_hop(self, start: float, to: np.ndarray, now: Observation) -> None:
        """Lift off at a time for a point (3,) beside where the foot stands."""
        settings = self._settings
        self._motion.plan_swing(self._turn.leg, start, to, now, settings.hop_s, settings.hop_height_m)
        self._touch_z = float(to[2])

    def landed(self, now: Observation, back: bool = False) -> bool:
        """Whether the foot has met ground: early contact ends the swing where it is.

        On its way `back` the foot knows where the ground is: what it meets before is in its way.
        """
        settings, reference = self._settings, self._motion.reference
        if not now.estimate.contact[self._turn.leg]:
            return False
        armed = reference.swing_t0 + settings.contact_armed * (reference.swing_t1 - reference.swing_t0)
        return self._due(now) or (not back and now.t >= armed and self._met_early(now))

    def touched(self, now: Observation) -> None:
        """Contact: the foot stands where it is, and its position is stored for the collapse test."""
        leg, foot = self._turn.leg, now.estimate.p_WF[self._turn.leg]
        off = 1e2 * (foot - self._motion.reference.swing_to)[:2] @ self._course.direction
        self._event("contact", f"{now.normal_force(leg):.0f} N, {off:+.1f} cm along the walk", foot)
        self._watch.touched(leg, foot)

    def search_below(self, now: Observation) -> str:
        """Late contact is looked for below; why it is given up, or "" as long as it is not."""
        if not self._due(now):
            return ""
        settings, leg = self._settings, self._turn.leg
        length = self._planner.leg_lengths(now.pose, now.estimate.p_WF)[leg]
        sunk = self._touch_z - now.estimate.p_WF[leg][2]
        if length <= settings.leg_length_max_m and sunk <= settings.descend_m:
            self._motion.descend(now)
            return ""
        return f"no contact down to {1e2 * sunk:.0f} cm below the plane, leg {length:.3f} m"

    def _due(self, now: Observation) -> bool:
        return now.t >= self._motion.reference.swing_t1 - LAND_AHEAD_S

    def _met_early(self, now: Observation) -> bool:
        """The swinging foot has met ground before its time.

        In mid-swing the leg's own inertia looks like a contact, eq. (7) being quasi-static: only a firm one
        counts, and only of a foot that has been stopped.
        """
        leg = self._turn.leg
        if now.normal_force(leg) <= self._settings.early_contact_n:
            return False
        _, planned, _ = SwingSpline(self._motion.reference).sample(np.array([now.t]))
        return float(now.estimate.v_WF[leg] @ planned[0]) < _STOPPED_SHARE * float(planned[0] @ planned[0])
