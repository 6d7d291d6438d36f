"""The stepping and probing of Fig. 6: from a target pose to a foothold that has borne its load, leg by leg."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from enum import StrEnum

import numpy as np

from surefoot.bus.messages import (
    ControlMode,
    FootholdRegions,
    FootholdRequest,
    LegStatus,
    MotionReference,
    Plan,
    PlanRequest,
)
from surefoot.components.fsm.foothold_planner import FootholdPlanner, plane_height
from surefoot.components.fsm.observation import Observation
from surefoot.components.fsm.stance_watch import StanceWatch
from surefoot.components.fsm.support_triangle import SupportTriangle
from surefoot.config.fsm import Fsm
from surefoot.config.robot import LEGS, Robot

_UP = np.array([0.0, 0.0, 1.0])
_ALWAYS = 1e9  # end of a constraint that lasts until the machine takes it away [s]
_LIFT_AHEAD_S = 0.10  # lift-off stays this far ahead until the base is ready: the MPC unloads the foot in time
_LAND_AHEAD_S = 0.03  # while contact is awaited, touch-down stays this far ahead
_HELD_WINDOW_S = 0.06  # a force is held if its mean over the end of its dwell is


class State(StrEnum):
    """States of Fig. 6."""

    PRE_OPT = "PRE_OPT"
    SEND = "SEND"
    OPT = "OPT"
    MOVE = "MOVE"
    DETECT_CONTACT = "DETECT_CONTACT"
    PROBE = "PROBE"
    PROBE_AROUND = "PROBE_AROUND"
    LEG_UP = "LEG_UP"
    RETURN_SAFE = "RETURN_SAFE"
    STOPPED = "STOPPED"


class ProbingCycle:
    """Takes the robot in one direction, one probed foothold after the other.

    Attributes:
        state: of Fig. 6.
        reason: why it was entered.
        reference: the motion asked of the MPC and the whole-body controller.
        foothold_request, plan_request: to publish, or None; the owner takes them away.
        certified_n: (4,) largest normal force each foothold has really borne [N].
        finished: every foot has advanced by the goal.
    """

    def __init__(self, robot: Robot, settings: Fsm, report: Callable[..., None]):
        """`report(kind, reason, **figures)` is called for every event."""
        self._settings = settings
        self._planner = FootholdPlanner(robot, settings)
        self._report = report
        self._watch = StanceWatch()
        self.state = State.STOPPED
        self.reason = ""
        self.reference = MotionReference(mode=ControlMode.BALANCE, normal_W=_UP)
        self.foothold_request: FootholdRequest | None = None
        self.plan_request: PlanRequest | None = None
        self.certified_n = np.zeros(4)
        self.finished = False
        self._id = 0
        self._heading = 0.0
        self._direction = np.array([1.0, 0.0])
        self._origin_W = np.zeros((4, 3))
        self._place = 0
        self._leg = -1
        self._candidate = 0
        self._around = 0
        self._candidates_W = np.zeros((0, 3))
        self._targets_W = np.zeros((4, 3))
        self._foothold_W = np.zeros(3)
        self._support_pose = np.zeros(6)
        self._envelope_W = np.zeros((0, 3))
        self._safe_W = np.zeros((4, 3))
        self._sunk: list[int] = []
        self._stop_after = ""
        self._inside_since: float | None = None
        self._touch_z = 0.0
        self._pressed: list[tuple[float, float]] = []
        self._told = 0
        self._entered = 0.0
        self._steps = {
            State.PRE_OPT: self._pre_opt,
            State.SEND: self._send,
            State.OPT: self._opt,
            State.MOVE: self._move,
            State.DETECT_CONTACT: self._detect_contact,
            State.PROBE: self._probe,
            State.PROBE_AROUND: self._detect_contact,
            State.LEG_UP: self._leg_up,
            State.RETURN_SAFE: self._detect_contact,
            State.STOPPED: lambda now: None,
        }

    # What the owner calls -------------------------------------------------------------------------------

    def stand(self, now: Observation, reason: str, seconds: float = 1.0) -> None:
        """Balance on four feet with the base in their middle."""
        feet = now.estimate.p_WF
        centre = self._planner.centre(feet, now.rpy[2])
        self._heading = now.rpy[2]
        self.reference = MotionReference(
            mode=ControlMode.BALANCE,
            normal_W=now.estimate.normal_W,
            p_WF=feet,
            leg_status=np.zeros(4, int),
            base_from=now.pose,
            base_to=self._planner.pose(centre, feet, now.estimate.normal_W, now.rpy[2]),
            base_t0=now.t,
            base_t1=now.t + seconds,
        )
        self._watch.anchor_W[:] = feet
        self._leg = -1
        self._enter(State.STOPPED, now, reason)

    def walk(self, now: Observation, direction_B: np.ndarray, name: str) -> None:
        """Start in a direction of the base frame (2,), on four feet."""
        self._heading = now.rpy[2]
        c, s = np.cos(self._heading), np.sin(self._heading)
        self._direction = np.array([[c, -s], [s, c]]) @ direction_B
        self._origin_W = now.estimate.p_WF.copy()
        self._watch.anchor_W[:] = now.estimate.p_WF
        self._place = 0
        self._sunk.clear()
        self._stop_after = ""
        self.finished = False
        self._enter(State.PRE_OPT, now, f"commanded {name}")

    def stop(self, now: Observation, reason: str) -> None:
        """Come to rest: at once on four feet, otherwise after the leg is back at its safe foothold."""
        if self.state in (State.DETECT_CONTACT, State.PROBE, State.PROBE_AROUND, State.LEG_UP):
            self._return_safe(now, reason)
        elif self.state == State.RETURN_SAFE:
            self._stop_after = reason
        elif self.state != State.STOPPED:
            self._clear_leg(now)
            self.stand(now, reason)

    def regions(self, answer: FootholdRegions, now: Observation) -> None:
        """The map's answer to a foothold request."""
        if self.state == State.SEND and answer.id == self._id:
            self._on_regions(answer, now)

    def plan(self, plan: Plan, now: Observation) -> None:
        """The trajectory optimisation's answer."""
        if self.state == State.OPT and plan.id == self._id:
            self._on_plan(plan, now)

    def step(self, now: Observation) -> None:
        """Advance by one tick."""
        self._watch_stance(now)
        self._steps[self.state](now)

    def message(self, t: float) -> MotionReference:
        """The reference to publish at time t."""
        return replace(
            self.reference,
            t=t,
            valid=True,
            state=str(self.state),
            reason=self.reason,
            leg=self._leg,
            candidate=self._candidate,
            around=self._around,
            force_index=min(self._told, len(self._envelope_W) - 1) if self.state == State.PROBE else -1,
            finished=self.finished,
        )

    # PRE_OPT, SEND, OPT ---------------------------------------------------------------------------------

    def _pre_opt(self, now: Observation) -> None:
        """Target pose, footholds and alternatives of the next leg; the present feet are stored as safe."""
        feet, settings = now.estimate.p_WF, self._settings
        self._safe_W = feet.copy()
        normal = now.estimate.normal_W
        leg = self._next_leg(feet, normal)
        if leg < 0:
            self.finished = True
            self.stand(now, "every foot has reached the goal")
            self._report("stopped", self.reason)
            return
        self._leg, self._candidate, self._around = leg, 0, 0
        self._targets_W = self._planner.targets(feet, self._target_xy(feet), self._heading, normal)
        ahead = settings.alternative_spacing_m * np.arange(settings.alternatives + 1)
        points = np.tile(self._targets_W[leg], (len(ahead), 1))
        points[:, :2] += ahead[:, None] * self._direction
        points[:, 2] = plane_height(feet, normal, points[:, :2])
        self._candidates_W = points
        self.reference = replace(self.reference, p_WF=feet.copy(), normal_W=normal, leg_status=np.zeros(4, int))
        self._ask(now, f"{LEGS[leg]} is next")

    def _next_leg(self, feet: np.ndarray, normal: np.ndarray) -> int:
        """The next leg of the crawl that has a step to make; a foot that sank goes first; -1 at the goal."""
        settings = self._settings
        while self._sunk:
            return self._sunk.pop(0)
        targets = self._planner.targets(feet, self._target_xy(feet), self._heading, normal)
        advance = (targets - feet)[:, :2] @ self._direction
        done = (feet - self._origin_W)[:, :2] @ self._direction
        for turn in range(4):
            leg = settings.crawl_order[(self._place + turn) % 4]
            arrived = 0.0 < settings.goal_m <= done[leg]
            if not arrived and advance[leg] >= settings.step_min_m:
                self._place = (self._place + turn + 1) % 4
                return leg
        return -1

    def _target_xy(self, feet: np.ndarray) -> np.ndarray:
        """Target base position: ahead of the feet's middle, on the line the walk began on."""
        start = self._planner.centre(self._origin_W, self._heading)
        done = (self._planner.centre(feet, self._heading) - start) @ self._direction
        return start + (done + self._settings.step_m) * self._direction

    def _ask(self, now: Observation, reason: str) -> None:
        """SEND: ask the map for the safe regions around the targets."""
        self._id += 1
        targets = self._targets_W.copy()
        targets[self._leg] = self._candidates_W[self._candidate]
        self._targets_W = targets
        self.foothold_request = FootholdRequest(
            t=now.t, valid=True, id=self._id, target_WF=targets, normal_W=self.reference.normal_W
        )
        self._enter(State.SEND, now, reason)

    def _send(self, now: Observation) -> None:
        if now.t - self._entered > 1.0:
            self._ask(now, "no answer on foothold/regions for 1 s: asked again")

    def _on_regions(self, answer: FootholdRegions, now: Observation) -> None:
        leg, feet = self._leg, self.reference.p_WF
        foothold = answer.foothold_WF[leg]
        settings = self._settings
        reserve = settings.around_radius_m if settings.probing and settings.probe_around else 0.0
        pose = self._planner.support_pose(
            leg,
            foothold,
            feet,
            self.reference.normal_W,
            self._heading,
            now.com_B,
            reserve * np.append(self._direction, 0.0),
        )
        if pose is None:
            self._event("rejected", "out of reach at every base height", now, foothold)
            self._next_candidate(now)
            return
        self._support_pose = pose
        centre = self._target_xy(feet)
        order = settings.crawl_order
        place = order.index(leg)
        self.plan_request = PlanRequest(
            t=now.t,
            valid=True,
            id=self._id,
            leg_order=np.array([order[(place + turn) % 4] for turn in range(4)]),
            p_WF=self._feet_now(now),
            lifted=self._in_air(),
            target_WF=answer.foothold_WF,
            base_target=self._planner.pose(centre, feet, self.reference.normal_W, self._heading),
            normal_W=self.reference.normal_W,
            region_a=answer.region_a,
            region_b=answer.region_b,
            region_active=answer.region_active,
        )
        self._foothold_W = foothold.copy()
        self._enter(State.OPT, now, "optimising the stride")

    def _opt(self, now: Observation) -> None:
        if now.t - self._entered > 2.0:
            self._ask(now, "no answer on trajopt/plan for 2 s: asked again")

    def _on_plan(self, plan: Plan, now: Observation) -> None:
        if plan.status != "ok":
            self._event("rejected", f"no plan: {plan.status}", now, self._foothold_W)
            self._next_candidate(now)
            return
        settings = self._settings
        self._foothold_W = plan.footholds_WF[self._leg].copy()
        if settings.fixed_force_n > 0.0:
            self._envelope_W = np.tile(settings.fixed_force_n * self.reference.normal_W, (6, 1))
        else:
            self._envelope_W = plan.envelope_W
        self._begin_move(now)

    # MOVE -----------------------------------------------------------------------------------------------

    def _begin_move(self, now: Observation) -> None:
        """The base goes inside the triangle of the other three; the swing waits for it."""
        settings = self._settings
        distance = np.linalg.norm(self._support_pose[:3] - now.estimate.p_WB)
        duration = max(settings.shift_s, distance / settings.shift_speed)
        if self._in_air():
            duration = distance / settings.shift_speed
        else:
            self._plan_swing(now.t + duration, self._foothold_W, now, settings.swing_s, settings.swing_height_m)
        self._shift_base(now, self._support_pose, duration)
        self._inside_since = None
        self._enter(State.MOVE, now, f"base shift for {LEGS[self._leg]}")

    def _move(self, now: Observation) -> None:
        settings, reference = self._settings, self.reference
        if now.t - self._entered > settings.shift_timeout_s + reference.base_t1 - reference.base_t0:
            self._event("rejected", "the base did not come to rest inside the triangle", now, self._foothold_W)
            self._next_candidate(now)
            return
        margin = SupportTriangle(reference.p_WF, self._leg).margin(now.com_W[:2])
        speed = float(np.hypot(*now.estimate.v_WB_W[:2]))
        inside = margin >= settings.shift_margin_m and speed < settings.shift_rest_speed
        if not inside:
            self._inside_since = None
        elif self._inside_since is None:
            self._inside_since = now.t
        ready = self._inside_since is not None and now.t - self._inside_since >= settings.shift_hold_s
        if self._in_air():
            if ready and now.t >= reference.base_t1:
                self._plan_swing(now.t, self._foothold_W, now, settings.swing_s, settings.swing_height_m)
                self._begin_swing(now)
        elif ready and now.t >= reference.swing_t0:
            self._begin_swing(now)
        elif not ready and now.t > reference.swing_t0 - _LIFT_AHEAD_S:
            start = now.t + _LIFT_AHEAD_S
            self.reference = replace(
                reference, swing_t0=start, swing_t1=start + settings.swing_s, **self._support(start)
            )

    def _begin_swing(self, now: Observation) -> None:
        self._lift_off(now, self._settings.swing_s)
        self._enter(State.DETECT_CONTACT, now, f"{LEGS[self._leg]} lifts off")

    # DETECT_CONTACT, also of PROBE_AROUND and RETURN_SAFE -----------------------------------------------

    def _detect_contact(self, now: Observation) -> None:
        """Early contact ends the swing where it is; late contact is looked for below, down to the limits."""
        settings, reference, leg = self._settings, self.reference, self._leg
        if now.estimate.contact[leg]:
            armed = reference.swing_t0 + settings.contact_armed * (reference.swing_t1 - reference.swing_t0)
            # In mid-swing the leg's own inertia looks like a light contact: only a firm one counts as early.
            due = now.t >= reference.swing_t1 - _LAND_AHEAD_S
            if due or (now.t >= armed and now.normal_force(leg) > settings.early_contact_n):
                self._touched(now)
                return
        if now.t >= reference.swing_t1 - _LAND_AHEAD_S:
            self._search_below(now)

    def _search_below(self, now: Observation) -> None:
        settings, reference, leg = self._settings, self.reference, self._leg
        foot = now.estimate.p_WF[leg]
        length = self._planner.leg_lengths(now.pose, now.estimate.p_WF)[leg]
        if length > settings.leg_length_max_m or self._touch_z - foot[2] > settings.descend_m:
            why = (
                f"no contact down to {1e2 * (self._touch_z - foot[2]):.0f} cm below the plane, leg {length:.3f} m"
            )
            if self.state == State.RETURN_SAFE:
                return
            self._event("rejected", why, now, foot)
            self._begin_leg_up(now, why)
            return
        landing = now.t + _LAND_AHEAD_S
        lower = settings.swing_v_touch * (landing - reference.swing_t1)
        status = reference.leg_status.copy()
        status[leg] = LegStatus.LANDING
        self.reference = replace(
            reference,
            swing_t1=landing,
            swing_to=reference.swing_to - lower * reference.normal_W,
            leg_status=status,
        )

    def _touched(self, now: Observation) -> None:
        """Contact: the foot stands where it is, and its position is stored for the collapse test."""
        leg = self._leg
        feet = now.estimate.p_WF.copy()
        off = 1e2 * (feet[leg] - self.reference.swing_to)[:2] @ self._direction
        self._event("contact", f"{now.normal_force(leg):.0f} N, {off:+.1f} cm along the walk", now, feet[leg])
        status = self.reference.leg_status.copy()
        trusted = self.state == State.RETURN_SAFE or not self._settings.probing
        status[leg] = LegStatus.STANCE if trusted else LegStatus.PROBING
        self.reference = replace(self.reference, p_WF=feet, leg_status=status, swing_leg=-1)
        self._watch.anchor_W[leg] = feet[leg] - self._drift(now)
        if self.state == State.RETURN_SAFE:
            self._returned(now)
        elif not self._settings.probing:
            self._accept(now, "contact; probing is off")
        elif self._around > 4:
            self._accept(now, "all forces were borne here and around")
        else:
            self._begin_probe(now)

    def _drift(self, now: Observation) -> np.ndarray:
        """(3,) what the estimate of the standing feet has drifted since they were trusted [m]."""
        standing = self._standing()
        moved = (now.estimate.p_WF - self._watch.anchor_W)[standing]
        return np.median(moved, axis=0) if len(moved) >= 3 else np.zeros(3)

    # PROBE, PROBE_AROUND --------------------------------------------------------------------------------

    def _begin_probe(self, now: Observation) -> None:
        """Eq. (6): every force of the envelope for 100 ms, from the force that is there now.

        Where the foot is to hop on afterwards, it is unloaded first, and the MPC knows of the hop from the
        start: a foot that leaves the ground under full load throws the base over.
        """
        settings = self._settings
        normal = self.reference.normal_W
        before = max(now.normal_force(self._leg), 5.0) * normal
        forces = [before, *self._envelope_W]
        begin = now.t + settings.settle_s
        if settings.probe_around:
            forces.append(settings.unload_n * normal)
            if self._around == 0:
                self._foothold_W = now.estimate.p_WF[self._leg].copy()
            lift = begin + len(self._envelope_W) * settings.dwell_s + settings.unload_s
            self._plan_swing(
                lift, self._around_point(self._around + 1), now, settings.hop_s, settings.hop_height_m
            )
        self.reference = replace(
            self.reference,
            probe_leg=self._leg,
            probe_t0=begin,
            probe_dwell_s=settings.dwell_s,
            probe_blend_s=settings.blend_s,
            probe_force_W=np.array(forces),
        )
        if settings.base_reference == "stride":
            centre = self._target_xy(self.reference.p_WF)
            pose = self._planner.pose(centre, self.reference.p_WF, self.reference.normal_W, self._heading)
            self._shift_base(now, pose, 4.0)
        self._pressed, self._told = [], 0
        where = f"around point {self._around}" if self._around else "foothold"
        self._enter(State.PROBE, now, f"{where}, up to {self._asked(len(self._envelope_W) - 1):.0f} N")

    def _probe(self, now: Observation) -> None:
        settings, leg = self._settings, self._leg
        moved = float(np.linalg.norm(self._watch.displacement(now.estimate.p_WF, self._standing())[leg]))
        if moved > settings.collapse_m:
            self._collapsed(now, moved)
            return
        since = now.t - self.reference.probe_t0
        self._pressed.append((since, now.normal_force(leg)))
        while self._told < len(self._envelope_W) and since >= (self._told + 1) * settings.dwell_s - 1e-9:
            self._force_held(now, self._told, moved)
            self._told += 1
        if self._told == len(self._envelope_W):
            if not settings.probe_around:
                self._accept(now, "all forces were borne")
            elif now.t >= self.reference.swing_t0 - 1e-9:
                self._next_point(now)

    def _force_held(self, now: Observation, index: int, moved: float) -> None:
        end = (index + 1) * self._settings.dwell_s
        window = [force for since, force in self._pressed if end - _HELD_WINDOW_S <= since <= end]
        held = float(np.mean(window)) if window else 0.0
        if not self._around:
            self.certified_n[self._leg] = max(held, self.certified_n[self._leg] if index else 0.0)
        asked = self._asked(index)
        short = "" if held >= self._settings.held_share * asked else ", short of the asked force"
        self._event(
            "force_held",
            f"{held:.0f} of {asked:.0f} N{short}",
            now,
            now.estimate.p_WF[self._leg],
            force_index=index,
            asked_n=asked,
            held_n=held,
            displacement_m=moved,
        )

    def _next_point(self, now: Observation) -> None:
        """PROBE_AROUND: front, back, left, right of the foothold, then back to its centre."""
        self._around += 1
        self._lift_off(now, self._settings.hop_s)
        what = "back to the foothold" if self._around == 5 else f"point {self._around} around the foothold"
        self._enter(State.PROBE_AROUND, now, what)

    def _around_point(self, number: int) -> np.ndarray:
        """(3,) where hop number 1..5 goes [m]."""
        along = np.append(self._direction, 0.0)
        left = np.array([-along[1], along[0], 0.0])
        offset = (along, -along, left, -left, 0.0 * along)[number - 1]
        return self._foothold_W + self._settings.around_radius_m * offset

    def _accept(self, now: Observation, reason: str) -> None:
        """The foothold is safe: only now does it replace the old one."""
        leg = self._leg
        self._safe_W[leg] = now.estimate.p_WF[leg]
        self._clear_leg(now)
        self._event("accepted", reason, now, now.estimate.p_WF[leg], held_n=float(self.certified_n[leg]))
        if self._stop_after:
            self.stand(now, self._stop_after)
        else:
            self._enter(State.PRE_OPT, now, f"{LEGS[leg]} stands safely")

    # Collapse, LEG_UP, RETURN_SAFE ----------------------------------------------------------------------

    def _collapsed(self, now: Observation, moved: float) -> None:
        index = min(max(self._told, 0), len(self._envelope_W) - 1)
        why = f"the foot moved {1e2 * moved:.1f} cm, limit {1e2 * self._settings.collapse_m:.1f} cm"
        foot = now.estimate.p_WF[self._leg]
        asked = self._asked(index)
        self._event("collapse", why, now, foot, force_index=index, asked_n=asked, displacement_m=moved)
        self._begin_leg_up(now, why)

    def _begin_leg_up(self, now: Observation, reason: str) -> None:
        """The foot leaves the ground at once; the base stays inside the other three feet."""
        leg, settings = self._leg, self._settings
        foot = now.estimate.p_WF[leg]
        status = np.zeros(4, int)
        status[leg] = LegStatus.SWING
        to = self._planner.below_hip(leg, now.pose, settings.leg_up_below_hip_m)
        # Straight up first: half the way to the place below the hip, so that the leg comes free of what it is in.
        to[:2] = 0.5 * (to[:2] + foot[:2])
        self.reference = replace(
            self.reference,
            leg_status=status,
            probe_leg=-1,
            swing_leg=leg,
            swing_t0=now.t,
            swing_t1=now.t + settings.leg_up_s,
            swing_from=foot.copy(),
            swing_to=to,
            # The foot is falling with the ground: to stop it in one tick would throw the base over.
            swing_v_from=now.estimate.v_WF[leg].copy(),
            swing_lands=False,
        )
        if settings.base_reference == "stride":
            self._shift_base(now, self._support_pose, settings.shift_s)
        self._enter(State.LEG_UP, now, reason)

    def _leg_up(self, now: Observation) -> None:
        if now.t >= self.reference.swing_t1:
            if self._stop_after:
                self._return_safe(now, self._stop_after)
            else:
                self._next_candidate(now)

    def _next_candidate(self, now: Observation) -> None:
        """The next alternative, or back to the last safe foothold when there is none."""
        self._candidate += 1
        self._around = 0
        if self._candidate < len(self._candidates_W):
            self._ask(now, f"alternative {self._candidate} of {len(self._candidates_W) - 1}")
        elif self._in_air():
            self._return_safe(now, "no safe foothold among the alternatives")
        else:
            self._returned(now)

    def _return_safe(self, now: Observation, reason: str) -> None:
        """The leg goes back to where it stood."""
        settings, leg = self._settings, self._leg
        if not self._stop_after:
            self._stop_after = reason
        self._plan_swing(now.t, self._safe_W[leg], now, settings.swing_s, settings.swing_height_m)
        self._lift_off(now, settings.swing_s)
        self._enter(State.RETURN_SAFE, now, reason)

    def _returned(self, now: Observation) -> None:
        reason = self._stop_after or "no safe foothold among the alternatives"
        self._clear_leg(now)
        if self._sunk:
            self._stop_after = ""
            self._enter(State.PRE_OPT, now, f"{LEGS[self._sunk[0]]} lost its foothold")
            return
        self._stop_after = ""
        self.stand(now, reason)
        self._report("stopped", reason)

    # Stance feet ----------------------------------------------------------------------------------------

    def _watch_stance(self, now: Observation) -> None:
        """A stance foot that sinks or slips later is a collapse too: it is the next to be moved."""
        if not self._settings.probing or self.state == State.STOPPED:
            return
        standing = self._standing()
        moved = np.linalg.norm(self._watch.displacement(now.estimate.p_WF, standing), axis=1)
        for leg in np.flatnonzero(standing & (moved > self._settings.collapse_m)):
            if int(leg) in self._sunk:
                continue
            why = f"{LEGS[leg]} moved {1e2 * moved[leg]:.1f} cm after it was accepted"
            self._report(
                "late_collapse", why, leg=int(leg), p_WF=now.estimate.p_WF[leg], displacement_m=float(moved[leg])
            )
            self._watch.anchor_W[leg] = now.estimate.p_WF[leg] - self._drift(now)
            self._sunk.append(int(leg))
            if (
                self.state in (State.DETECT_CONTACT, State.PROBE, State.PROBE_AROUND, State.LEG_UP)
                or self._in_air()
            ):
                self._return_safe(now, why)
            else:
                self._clear_leg(now)
                self._enter(State.PRE_OPT, now, why)

    # Parts of the reference -----------------------------------------------------------------------------

    def _standing(self) -> np.ndarray:
        return self.reference.leg_status == LegStatus.STANCE

    def _in_air(self) -> bool:
        return bool((self.reference.leg_status == LegStatus.SWING).any())

    def _probing(self) -> bool:
        return bool((self.reference.leg_status == LegStatus.PROBING).any())

    def _feet_now(self, now: Observation) -> np.ndarray:
        """(4, 3) where the plan starts from: the feet that stand, and the one in the air where it is."""
        feet = self.reference.p_WF.copy()
        if self._in_air():
            feet[self._leg] = now.estimate.p_WF[self._leg]
        return feet

    def _shift_base(self, now: Observation, pose: np.ndarray, duration: float) -> None:
        self.reference = replace(
            self.reference, base_from=now.pose, base_to=pose, base_t0=now.t, base_t1=now.t + duration
        )

    def _plan_swing(self, start: float, to: np.ndarray, now: Observation, duration: float, height: float) -> None:
        settings = self._settings
        self.reference = replace(
            self.reference,
            swing_leg=self._leg,
            swing_t0=start,
            swing_t1=start + duration,
            swing_from=now.estimate.p_WF[self._leg].copy(),
            swing_to=to,
            swing_height=height,
            swing_v_lift=settings.swing_v_lift,
            swing_v_touch=settings.swing_v_touch,
            swing_lands=True,
            **self._support(start),
        )
        self._touch_z = float(to[2])

    def _support(self, start: float) -> dict:
        """Eq. (5) from lift-off on, until the leg's probing is complete."""
        on = self._settings.support_polygon and self._settings.probing
        return {
            "support_leg": self._leg if on else -1,
            "support_t0": min(start, self.reference.support_t0) if self._in_air() or self._probing() else start,
            "support_t1": _ALWAYS,
            "support_margin_m": self._settings.margin_m,
        }

    def _lift_off(self, now: Observation, duration: float) -> None:
        """The leg leaves the ground now."""
        leg = self._leg
        feet = now.estimate.p_WF.copy()
        feet[leg] = self.reference.swing_to
        status = np.zeros(4, int)
        status[leg] = LegStatus.SWING
        self.reference = replace(
            self.reference,
            p_WF=feet,
            leg_status=status,
            probe_leg=-1,
            swing_from=now.estimate.p_WF[leg].copy(),
            swing_t0=now.t,
            swing_t1=now.t + duration,
            **self._support(now.t),
        )

    def _clear_leg(self, now: Observation) -> None:
        """All feet stand; no constraint of probing acts."""
        self.reference = replace(
            self.reference,
            p_WF=now.estimate.p_WF.copy(),
            leg_status=np.zeros(4, int),
            swing_leg=-1,
            support_leg=-1,
            probe_leg=-1,
        )

    def _asked(self, index: int) -> float:
        return float(self._envelope_W[index] @ self.reference.normal_W)

    def _enter(self, state: State, now: Observation, reason: str) -> None:
        self.state, self.reason, self._entered = state, reason, now.t
        self._report("transition", reason, leg=self._leg)

    def _event(self, kind: str, reason: str, now: Observation, p_WF: np.ndarray, **figures) -> None:
        self._report(kind, reason, leg=self._leg, p_WF=p_WF.copy(), **figures)

    @property
    def counters(self) -> dict[str, int]:
        """Candidate and around point of the moment, for events."""
        return {"candidate": self._candidate, "around": self._around}
