"""LEG_UP and RETURN_SAFE of Fig. 6: off ground that does not bear, and back to where the leg stood."""

from __future__ import annotations

import numpy as np

from surefoot.bus.messages import LegStatus
from surefoot.components.fsm.arrow import Arrow, Fork
from surefoot.components.fsm.course import Course
from surefoot.components.fsm.foothold_planner import FootholdPlanner
from surefoot.components.fsm.leg_swing import LegSwing
from surefoot.components.fsm.leg_turn import LegTurn
from surefoot.components.fsm.motion import Motion
from surefoot.components.fsm.observation import Observation
from surefoot.components.fsm.stance_watch import StanceWatch
from surefoot.components.fsm.state import State
from surefoot.components.memory import Memory
from surefoot.config.fsm import Fsm
from surefoot.config.robot import LEGS


class Retreat:
    """How the leg whose turn it is gives up a foothold, or its turn."""

    memory = Memory("_freed", "_why_back", "_swing_s")

    def __init__(
        self,
        settings: Fsm,
        planner: FootholdPlanner,
        course: Course,
        watch: StanceWatch,
        swing: LegSwing,
        motion: Motion,
        turn: LegTurn,
    ):
        self._settings, self._planner, self._course, self._watch = settings, planner, course, watch
        self._swing, self._motion, self._turn = swing, motion, turn
        self._freed = False
        self._why_back = ""
        self._swing_s = settings.swing_s

    def begin_leg_up(self, now: Observation, freed: bool = False) -> None:
        """The foot leaves the ground at once; the base stays inside the other three feet.

        After that comes the next candidate, or where a foot is `freed` the one that it was on its way to.
        """
        settings, turn = self._settings, self._turn
        self._freed = freed
        if not freed:
            turn.failed_W.append(turn.foothold_W.copy())
        to = self._planner.below_hip(turn.leg, now.pose, settings.leg_up_below_hip_m)
        # Half the way to the place below the hip, or straight up out of a hole, whose edge would catch the foot.
        to[:2] += (1.0 if freed else 0.5) * (now.estimate.p_WF[turn.leg, :2] - to[:2])
        # With the base lowered the place below the hip may be in the ground.
        to[2] = max(to[2], self._watch.safe(turn.leg)[2] + settings.swing_height_m)
        self._motion.raise_leg(turn.leg, now, to)
        if settings.base_reference == "stride":
            self._motion.shift_base(now, turn.support_pose, settings.shift_s)

    def leg_up(self, now: Observation) -> Arrow | None:
        """LEG_UP: once the foot is clear, on to where it can still go."""
        turn = self._turn
        if now.t < self._motion.reference.swing_t1:
            return None
        if turn.no_way_back:
            return Arrow(State.STOPPED, f"{turn.halt}; {turn.no_way_back}" if turn.halt else turn.no_way_back)
        if self._freed:
            return Arrow(State.SEND, f"{LEGS[turn.leg]} is free of the ground that gave way")
        return Arrow(Fork.UNFIT)

    def begin_return(self, now: Observation, why: str) -> None:
        """The leg goes back to where it stood; a foot that presses is unloaded first, and the MPC knows ahead.

        A foot that leaves the ground under load throws the base over. From where the base has gone for a far
        foothold the way back may be too long for the leg: then the base comes back with it.
        """
        settings, motion, leg = self._settings, self._motion, self._turn.leg
        self._why_back, self._turn.no_way_back = why, ""
        safe_W = self._watch.safe(leg)
        self._swing_s = max(settings.swing_s, self._bring_in_reach(safe_W, now))
        if motion.in_air:
            self._swing.plan(now.t, safe_W, now)
            motion.lift_off(now, self._swing_s)
        else:
            normal = motion.reference.normal_W
            forces = np.array([now.normal_force(leg) * normal, settings.unload_n * normal])
            motion.press(leg, now.t, forces)
            self._swing.plan(now.t + settings.unload_s, safe_W, now)

    def return_safe(self, now: Observation) -> Arrow | None:
        """RETURN_SAFE: unloaded, through the air, and down where the leg stood before."""
        motion, leg = self._motion, self._turn.leg
        if not motion.in_air:
            if now.t >= motion.reference.swing_t0:
                motion.lift_off(now, self._swing_s)
            return None
        if self._swing.landed(now, back=True):
            self._swing.touched(now)
            motion.touch_down(now, LegStatus.COLLAPSING if self._watch.sunk[leg] else LegStatus.STANCE)
            return Arrow(Fork.BACK, self._why_back)
        why = self._swing.search_below(now)
        if not why:
            return None
        self._turn.no_way_back = f"{LEGS[leg]} has no ground to go back to: {why}"
        return Arrow(State.LEG_UP, why)

    def back(self, now: Observation, why: str) -> Arrow:
        """The leg is back: stop as was asked, or go on with a leg whose ground has given way."""
        turn = self._turn
        self._motion.plant(now)
        if turn.halt:
            return Arrow(State.STOPPED, turn.halt)
        if self._course.waiting:
            return Arrow(State.PRE_OPT, f"{LEGS[self._course.waiting[0]]} lost its foothold")
        if self._may_put_off:
            return Arrow(State.PRE_OPT, f"{why}: {LEGS[turn.leg]} is put off")
        return Arrow(State.STOPPED, why)

    def _bring_in_reach(self, safe_W: np.ndarray, now: Observation) -> float:
        """Shift the base, if it must, to where the leg reaches its safe foothold (3,); how long that takes [s].

        The ground there may have given way by as much as is no collapse.
        """
        settings, planner, motion, leg = self._settings, self._planner, self._motion, self._turn.leg
        feet, normal, heading = motion.reference.p_WF.copy(), motion.reference.normal_W, self._course.heading
        feet[leg] = safe_W - settings.collapse_m * normal
        if planner.leg_lengths(now.pose, feet)[leg] <= settings.leg_length_max_m:
            return 0.0
        for length_m in (settings.leg_length_plan_m, settings.leg_length_max_m):
            pose = planner.support_pose(
                leg, feet[leg], feet, normal, heading, now.com_B, np.zeros(3), length_m=length_m
            )
            if pose is not None:
                break
        else:
            return 0.0
        duration = max(settings.shift_s, motion.time_to(pose, now))
        motion.shift_base(now, pose, duration)
        return duration

    @property
    def _may_put_off(self) -> bool:
        """Another leg may move first: this one stands on ground that has borne it before."""
        return self._settings.put_off and self._course.stuck and bool(self._motion.grounded.all())
