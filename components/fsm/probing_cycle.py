"""The stepping and probing of Fig. 6: from a target pose to a foothold that has borne its load, leg by leg."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace

import numpy as np

from surefoot.bus.messages import FootholdRegions, LegStatus, MotionReference, Plan
from surefoot.components.fsm.balance import Balance
from surefoot.components.fsm.certificates import Certificates
from surefoot.components.fsm.course import AROUND_POINTS, Course
from surefoot.components.fsm.foothold_planner import FootholdPlanner
from surefoot.components.fsm.leg_turn import LegTurn
from surefoot.components.fsm.motion import LAND_AHEAD_S, Motion, Region
from surefoot.components.fsm.observation import Observation
from surefoot.components.fsm.probe import Held, Probe, peak_n
from surefoot.components.fsm.questions import Questions
from surefoot.components.fsm.stance_watch import StanceWatch
from surefoot.components.fsm.state import State
from surefoot.components.fsm.static_limit import static_limit
from surefoot.components.gait.swing_spline import SwingSpline
from surefoot.config.fsm import Fsm
from surefoot.config.robot import GRAVITY, LEGS, Robot

_STAND_S = 1.0
"""Time to bring the base over the middle of the feet."""

_STOPPED_SHARE = 0.5
"""A swinging foot slower than this share of its planned velocity has been stopped by something."""

_NO_FOOTHOLD = "no safe foothold among the alternatives"


class ProbingCycle:
    """Takes the robot in one direction, one probed foothold after the other.

    Attributes:
        state: of Fig. 6.
        reason: why it was entered.
        motion: what is asked of the MPC and the whole-body controller.
        questions: what it asks of the map and of the trajectory optimisation.
        finished: every foot has advanced by the goal.
    """

    def __init__(self, robot: Robot, settings: Fsm, report: Callable[..., None]):
        """`report(kind, reason, **figures)` is called for every event."""
        self._settings = settings
        self._planner = FootholdPlanner(robot, settings)
        self._weight_n = robot.mass * GRAVITY
        self._course = Course(self._planner, settings)
        self._report = report
        self._watch = StanceWatch()
        self._balance = Balance(settings)
        self._press = Probe(settings)
        self.motion = Motion(settings)
        self.questions = Questions()
        self.state = State.STOPPED
        self.reason = ""
        self._certificates = Certificates(settings)
        self.finished = False
        self._turn = LegTurn()
        self._repeated = self._freed = False
        self._eased = ""  # why the press is broken off
        self._moved_before = np.zeros(4)
        self._borne_n = self._borne_m = 0.0  # largest force this candidate has held, displacement under it
        self._foot_radius_m = robot.foot.radius
        self._touch_z = 0.0
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
            State.RETURN_SAFE: self._go_back,
            State.STOPPED: lambda now: None,
        }

    @property
    def reference(self) -> MotionReference:
        """The motion asked for now."""
        return self.motion.reference

    @property
    def certified_n(self) -> np.ndarray:
        """(4,) largest normal force each foothold has really borne [N]."""
        return self._certificates.held_n

    @property
    def displaced_m(self) -> np.ndarray:
        """(4,) how far the foot had moved under it from where it touched down [m]."""
        return self._certificates.displaced_m

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
        self._course.begin(self._footing(now), now.rpy[2], direction_B)
        for leg in np.flatnonzero(~self.motion.grounded):
            self._course.put_first(int(leg))
        self.finished = False
        self._enter(State.PRE_OPT, now, f"commanded {name}")

    def stop(self, now: Observation, reason: str) -> None:
        """Come to rest: at once on four trusted feet, otherwise after the leg is back at its safe foothold."""
        if self.state == State.RETURN_SAFE:
            self._turn.halt = reason
        elif self.motion.in_air or self.state == State.PROBE:
            self._turn.halt = reason
            self._return_safe(now, reason)
        elif self.state != State.STOPPED:
            self.motion.plant(now)
            self.stand(now, reason)

    def regions(self, answer: FootholdRegions, now: Observation) -> None:
        """The map's answer to a foothold request."""
        if self.state == State.SEND and self.questions.answered_by(answer):
            self._on_regions(answer, now)

    def plan(self, plan: Plan, now: Observation) -> None:
        """The trajectory optimisation's answer."""
        if self.state == State.OPT and self.questions.answered_by(plan):
            self._on_plan(plan, now)

    def step(self, now: Observation) -> None:
        """Advance by one tick."""
        self._watch.update(now.estimate.p_WF, self.motion.trusted)
        self._watch.load(now.estimate.force_W @ now.estimate.normal_W, self.motion.bearing)
        if self._settings.probing:
            self._watch_stance(now)
            self._watch_balance(now)
            self._free_sunk(now)
        self._steps[self.state](now)

    def message(self, t: float) -> MotionReference:
        """The reference to publish at time t."""
        press = self._press
        return replace(
            self.reference,
            t=t,
            valid=True,
            state=str(self.state),
            reason=self.reason,
            leg=self._turn.leg,
            candidate=self._turn.candidate,
            around=self._turn.around,
            force_index=min(press.told, len(press.asked_W) - 1) if self.state == State.PROBE else -1,
            finished=self.finished,
            force_max_n=self._force_max_n,
        )

    @property
    def counters(self) -> dict[str, int]:
        """Candidate and around point of the moment, for events."""
        return {"candidate": self._turn.candidate, "around": self._turn.around}

    # PRE_OPT, SEND, OPT ---------------------------------------------------------------------------------

    def _pre_opt(self, now: Observation) -> None:
        """Target pose, footholds and alternatives of the next leg."""
        feet, normal = self._footing(now), now.estimate.normal_W
        leg = self._course.next_leg(feet, normal)
        if leg < 0:
            self.finished = not self._course.stuck
            self.stand(now, "every foot has reached the goal" if self.finished else _NO_FOOTHOLD)
            self._report("stopped", self.reason)
            return
        targets = self._course.targets(feet, normal)
        self._turn.begin(leg, targets, self._course.candidates(targets[leg], feet, normal))
        self.motion.on_plane(now)
        self._ask(now, f"{LEGS[leg]} is next")

    def _ask(self, now: Observation, reason: str) -> None:
        """SEND: ask the map for the safe regions around the targets."""
        targets = self._turn.targets_W.copy()
        targets[self._turn.leg] = self._turn.candidates_W[self._turn.candidate]
        self._turn.targets_W = targets
        feet, normal = self.reference.p_WF, self.reference.normal_W
        base = self._course.base_target(feet, normal)
        self.questions.ask_regions(now.t, targets, normal, p_WF=self._feet_now(now), base_target=base)
        self._enter(State.SEND, now, reason)

    def _send(self, now: Observation) -> None:
        if now.t - self._entered > 1.0:
            self._ask(now, "no answer on foothold/regions for 1 s: asked again")

    def _on_regions(self, answer: FootholdRegions, now: Observation) -> None:
        leg, feet, normal = self._turn.leg, self.reference.p_WF, self.reference.normal_W
        self._turn.answer = answer
        foothold, settings = answer.foothold_WF[leg], self._settings
        unfit = self._unfit(answer)
        if unfit:
            self._event("rejected", unfit, now, foothold)
            self._next_candidate(now)
            return
        around = settings.around_radius_m if settings.probing and settings.probe_around else 0.0
        ahead = around * np.append(self._course.direction, 0.0)
        depth = 0.0 if answer.region_active[leg] else settings.depth_reserve_m  # a map knows how deep it is
        heading = self._course.heading
        pose = self._planner.support_pose(leg, foothold, feet, normal, heading, now.com_B, ahead, depth)
        if pose is None:
            self._event("rejected", "out of reach at every base height", now, foothold)
            self._next_candidate(now)
            return
        self._turn.support_pose = pose
        self.questions.ask_plan(
            now.t,
            answer,
            normal,
            leg_order=self._course.order_from(leg),
            p_WF=self._feet_now(now),
            lifted=self.motion.in_air,
            base_target=self._course.base_target(feet, normal),
            force_max_n=self._force_max_n,
        )
        self._turn.foothold_W = foothold.copy()
        self._enter(State.OPT, now, "optimising the stride")

    def _unfit(self, answer: FootholdRegions) -> str:
        """Why the answer's foothold is not worth a step, or "": the map forbids it, or it has been tried."""
        leg = self._turn.leg
        if not answer.safe[leg]:
            return answer.reasons[leg] if answer.reasons else "the map knows no safe cell near it"
        return self._tried(answer.foothold_WF[leg])

    def _tried(self, foothold_W: np.ndarray) -> str:
        """Which foothold that was tried in vain a place (3,) is, or ""."""
        return self._turn.tried(foothold_W, 0.5 * self._foot_radius_m)

    def _opt(self, now: Observation) -> None:
        if now.t - self._entered > 2.0:
            self._ask(now, "no answer on trajopt/plan for 2 s: asked again")

    def _on_plan(self, plan: Plan, now: Observation) -> None:
        if plan.status != "ok":
            self._event("rejected", f"no plan: {plan.status}", now, self._turn.foothold_W)
            self._next_candidate(now)
            return
        self._turn.foothold_W = plan.footholds_WF[self._turn.leg].copy()
        # It may be anywhere in its region, as that of the last candidate.
        tried = self._tried(self._turn.foothold_W)
        if tried:
            self._event("rejected", tried, now, self._turn.foothold_W)
            self._next_candidate(now)
            return
        fixed = self._settings.fixed_force_n
        self._turn.envelope_W = np.tile(fixed * self.reference.normal_W, (6, 1)) if fixed else plan.envelope_W
        self._begin_move(now)

    # MOVE -----------------------------------------------------------------------------------------------

    def _begin_move(self, now: Observation) -> None:
        """The base goes inside the triangle of the other three; the swing waits for it."""
        settings = self._settings
        distance = float(np.linalg.norm(self._turn.support_pose[:3] - now.estimate.p_WB))
        duration = distance / settings.shift_speed
        if not self.motion.in_air:
            duration = max(settings.shift_s, duration)
            self._plan_swing(now.t + duration, self._turn.foothold_W, now, self._turn.region)
        self.motion.shift_base(now, self._turn.support_pose, duration)
        self._balance.begin_shift()
        self._enter(State.MOVE, now, f"base shift for {LEGS[self._turn.leg]}")

    def _move(self, now: Observation) -> None:
        settings, reference, motion = self._settings, self.reference, self.motion
        if now.t - self._entered > settings.shift_timeout_s + reference.base_t1 - reference.base_t0:
            self._event(
                "rejected", "the base did not come to rest inside the triangle", now, self._turn.foothold_W
            )
            self._next_candidate(now)
            return
        ready = self._balance.ready(now, reference, self._turn.leg)
        if motion.in_air:
            if ready and now.t >= reference.base_t1:
                self._plan_swing(now.t, self._turn.foothold_W, now, self._turn.region)
                self._begin_swing(now)
        elif ready and now.t >= reference.swing_t0:
            self._begin_swing(now)
        elif not ready:
            motion.postpone(now, settings.swing_s)

    def _begin_swing(self, now: Observation) -> None:
        settings, reference = self._settings, self.reference
        if settings.base_reference == "stride":
            # Fig. 9: the base goes on along its stride and does not wait until the probing is over.
            target = self._course.base_target(now.estimate.p_WF, reference.normal_W)
            self.motion.shift_base(now, target, settings.stride_s)
        self.motion.lift_off(now, settings.swing_s)
        self._enter(State.DETECT_CONTACT, now, f"{LEGS[self._turn.leg]} lifts off")

    def _plan_swing(self, start: float, to: np.ndarray, now: Observation, region: Region | None = None) -> None:
        settings = self._settings
        self.motion.plan_swing(self._turn.leg, start, to, now, settings.swing_s, settings.swing_height_m, region)
        self._touch_z = float(to[2])

    def _plan_hop(self, start: float, to: np.ndarray, now: Observation) -> None:
        settings = self._settings
        self.motion.plan_swing(self._turn.leg, start, to, now, settings.hop_s, settings.hop_height_m)
        self._touch_z = float(to[2])

    # DETECT_CONTACT, also of PROBE_AROUND and RETURN_SAFE -----------------------------------------------

    def _detect_contact(self, now: Observation) -> None:
        """Early contact ends the swing where it is; late contact is looked for below, down to the limits."""
        settings, reference, leg = self._settings, self.reference, self._turn.leg
        due = now.t >= reference.swing_t1 - LAND_AHEAD_S
        if now.estimate.contact[leg]:
            armed = reference.swing_t0 + settings.contact_armed * (reference.swing_t1 - reference.swing_t0)
            if due or (now.t >= armed and self._met_early(now)):
                self._touched(now)
                return
        if due:
            self._search_below(now)

    def _met_early(self, now: Observation) -> bool:
        """The swinging foot has met ground before its time.

        In mid-swing the leg's own inertia looks like a contact, eq. (7) being quasi-static: only a firm one
        counts, and only of a foot that has been stopped. On its way back the foot knows where the ground is: what
        it meets before is in its way.
        """
        leg = self._turn.leg
        if self.state == State.RETURN_SAFE or now.normal_force(leg) <= self._settings.early_contact_n:
            return False
        _, planned, _ = SwingSpline(self.reference).sample(np.array([now.t]))
        return float(now.estimate.v_WF[leg] @ planned[0]) < _STOPPED_SHARE * float(planned[0] @ planned[0])

    def _search_below(self, now: Observation) -> None:
        settings, foot = self._settings, now.estimate.p_WF[self._turn.leg]
        length = self._planner.leg_lengths(now.pose, now.estimate.p_WF)[self._turn.leg]
        sunk = self._touch_z - foot[2]
        if length <= settings.leg_length_max_m and sunk <= settings.descend_m:
            self.motion.descend(now)
            return
        why = f"no contact down to {1e2 * sunk:.0f} cm below the plane, leg {length:.3f} m"
        if self.state == State.RETURN_SAFE:
            self._turn.no_way_back = f"{LEGS[self._turn.leg]} has no ground to go back to: {why}"
        else:
            self._event("rejected", why, now, foot)
        self._begin_leg_up(now, why)

    def _touched(self, now: Observation) -> None:
        """Contact: the foot stands where it is, and its position is stored for the collapse test."""
        leg, foot = self._turn.leg, now.estimate.p_WF[self._turn.leg]
        off = 1e2 * (foot - self.reference.swing_to)[:2] @ self._course.direction
        self._event("contact", f"{now.normal_force(leg):.0f} N, {off:+.1f} cm along the walk", now, foot)
        self._watch.touched(leg, foot)
        self._repeated = False
        if not self._turn.around:
            self._borne_n = self._borne_m = 0.0
        if self.state == State.RETURN_SAFE:
            self.motion.touch_down(now, LegStatus.COLLAPSING if self._watch.sunk[leg] else LegStatus.STANCE)
            self._returned(now, self.reason)
            return
        self.motion.touch_down(now, LegStatus.PROBING if self._settings.probing else LegStatus.STANCE)
        if not self._settings.probing:
            self._accept(now, "contact; probing is off")
        elif self._turn.around > AROUND_POINTS:
            self._accept(now, "all forces were borne here and around")
        elif not self._turn.around and self._known_to_bear(foot):
            self._borne_n = float(self._turn.answer.held_n[leg])
            self._accept(now, self._known_to_bear(foot))
        elif self._turn.around and self._drop(foot) > self._settings.around_drop_m:
            why = f"the ground beside the foothold lies {1e2 * self._drop(foot):.1f} cm lower"
            self._event("rejected", why, now, foot)
            self._begin_leg_up(now, why)
        else:
            self._begin_probe(now)

    def _known_to_bear(self, foot_W: np.ndarray) -> str:
        """Why a foothold need not be probed, or "": the map knows this very spot to bear what the stride needs."""
        held_n = float(self._turn.answer.held_n[self._turn.leg])
        needed = peak_n(self._turn.envelope_W, self.reference.normal_W)
        off = float(np.linalg.norm(foot_W - self._turn.answer.foothold_WF[self._turn.leg]))
        if not self._settings.adaptive_probing or held_n <= 0.0 or held_n < needed or off > self._foot_radius_m:
            return ""
        return f"known to bear {held_n:.0f} N of {needed:.0f} N needed, {1e3 * off:.0f} mm away: not probed again"

    def _drop(self, foot_W: np.ndarray) -> float:
        """How much lower a point around it is than the foothold, along the normal [m]."""
        return float((self._turn.foothold_W - foot_W) @ self.reference.normal_W)

    # PROBE, PROBE_AROUND --------------------------------------------------------------------------------

    def _begin_probe(self, now: Observation) -> None:
        """Eq. (6): every force of the envelope for 100 ms, from the force that is there now.

        Where the foot is to hop on afterwards, it is unloaded first, and the MPC knows of the hop from the
        start: a foot that leaves the ground under full load throws the base over.
        """
        settings, press, normal = self._settings, self._press, self.reference.normal_W
        inside = settings.margin_m + settings.margin_extra_m
        limit = static_limit(self.reference.p_WF, self._turn.leg, inside, self._weight_n)
        press.ask(self._turn.envelope_W, settings.force_over_static * limit, normal)
        forces = [max(now.normal_force(self._turn.leg), 5.0) * normal, *press.asked_W]
        begin = now.t + settings.settle_s
        if settings.probe_around:
            forces.append(settings.unload_n * normal)
            if self._turn.around == 0:
                self._turn.foothold_W = now.estimate.p_WF[self._turn.leg].copy()
            point = self._course.around(self._turn.foothold_W, self._turn.around + 1)
            self._plan_hop(begin + press.duration_s + settings.unload_s, point, now)
        self._eased = ""
        self._moved_before = self._watch.displacement(now.estimate.p_WF)
        self.motion.press(self._turn.leg, begin, np.array(forces))
        press.begin(begin)
        where = f"around point {self._turn.around}" if self._turn.around else "foothold"
        where += ", again: the force fell short" if self._repeated else ""
        peak, needed = peak_n(press.asked_W, normal), peak_n(self._turn.envelope_W, normal)
        short = f" of {needed:.0f}, statics allow no more" if peak < needed - 0.5 else ""
        self._enter(State.PROBE, now, f"{where}, up to {peak:.0f} N{short}")

    def _probe(self, now: Observation) -> None:
        settings, leg, press = self._settings, self._turn.leg, self._press
        moved = self._watch.displacement(now.estimate.p_WF)[leg]
        if moved > settings.collapse_m:
            self._collapsed(now, moved)
            return
        if self._eased:
            if now.t >= self.reference.probe_t0 + settings.unload_s:
                self._stay(now, self._eased)
            return
        for held in press.update(now.t, now.normal_force(leg), self.reference.normal_W):
            self._force_held(now, held, moved)
        self._ease_for_others(now)
        if self._eased or not press.over:
            return
        if press.short(self.reference.normal_W) and not self._repeated:
            self._repeated = True
            self._begin_probe(now)
        elif not settings.probe_around:
            self._accept(now, "all forces were borne")
        elif now.t >= self.reference.swing_t0 - 1e-9:
            self._next_point(now)

    def _ease_for_others(self, now: Observation) -> None:
        """A stance foot yields under what another presses: the press ends before it is a collapse.

        The opposite foot bears the press and its own share, more than it was probed with. Without the press it
        has less than half of that; it is the next to be moved.
        """
        moved = np.where(
            self.motion.trusted, self._watch.displacement(now.estimate.p_WF) - self._moved_before, 0.0
        )
        worst = int(np.argmax(moved))
        if moved[worst] > self._settings.yield_m:
            self._eased = f"{LEGS[worst]} yielded {1e2 * moved[worst]:.1f} cm under the press"
            self._course.put_first(worst)
            self.motion.ease(self._turn.leg, now, self._settings.unload_n)

    def _stay(self, now: Observation, why: str) -> None:
        """The press was broken off: the foot stays, certified for what it has borne, or to be probed again."""
        if self._borne_n > 0.0:
            self._accept(now, why)
        else:
            self._course.put_first(self._turn.leg)
            self.motion.plant(now)
            self._enter(State.PRE_OPT, now, why)

    def _force_held(self, now: Observation, held: Held, moved: float) -> None:
        if not self._turn.around and held.held_n > self._borne_n:
            self._borne_n, self._borne_m = held.held_n, moved
        short = "" if held.enough else ", short of the asked force"
        self._event(
            "force_held",
            f"{held.held_n:.0f} of {held.asked_n:.0f} N{short}",
            now,
            now.estimate.p_WF[self._turn.leg],
            force_index=held.index,
            asked_n=held.asked_n,
            held_n=held.held_n,
            displacement_m=moved,
        )

    def _next_point(self, now: Observation) -> None:
        """PROBE_AROUND: front, back, left, right of the foothold, then back to its centre."""
        self._turn.around += 1
        self.motion.lift_off(now, self._settings.hop_s)
        back = self._turn.around > AROUND_POINTS
        what = "back to the foothold" if back else f"point {self._turn.around} around the foothold"
        self._enter(State.PROBE_AROUND, now, what)

    def _accept(self, now: Observation, reason: str) -> None:
        """The foothold is safe: only now does it replace the old one."""
        leg, foot = self._turn.leg, now.estimate.p_WF[self._turn.leg]
        self._watch.trust(leg, foot)
        self.motion.trust(leg)
        self._course.settle(leg)
        self.motion.plant(now)
        if self._settings.probing:
            self._certificates.give(leg, self._borne_n, self._borne_m)
            peak = peak_n(self._turn.envelope_W, self.reference.normal_W)
            if self._borne_n < self._settings.held_share * peak:
                reason = f"{reason}; certified for {self._borne_n:.0f} of {peak:.0f} N only"
        held_n, moved = float(self.certified_n[leg]), float(self.displaced_m[leg])
        self._event("accepted", reason, now, foot, held_n=held_n, displacement_m=moved)
        self._enter(State.PRE_OPT, now, f"{LEGS[leg]} stands safely")

    # Collapse, LEG_UP, RETURN_SAFE ----------------------------------------------------------------------

    def _collapsed(self, now: Observation, moved: float) -> None:
        press = self._press
        index = min(press.told, len(press.asked_W) - 1)
        why = f"the foot moved {1e2 * moved:.1f} cm, limit {1e2 * self._settings.collapse_m:.1f} cm"
        asked = press.asked_n(index, self.reference.normal_W)
        foot = now.estimate.p_WF[self._turn.leg]
        self._event("collapse", why, now, foot, force_index=index, asked_n=asked, displacement_m=moved)
        self._begin_leg_up(now, why)

    def _begin_leg_up(self, now: Observation, reason: str, freed: bool = False) -> None:
        """The foot leaves the ground at once; the base stays inside the other three feet.

        After that comes the next candidate, or where a foot is `freed` the one that it was on its way to.
        """
        leg, settings = self._turn.leg, self._settings
        self._freed = freed
        if not freed:
            self._turn.failed_W.append(self._turn.foothold_W.copy())
        to = self._planner.below_hip(leg, now.pose, settings.leg_up_below_hip_m)
        # Half the way to the place below the hip, or straight up out of a hole, whose edge would catch the foot.
        to[:2] += (1.0 if freed else 0.5) * (now.estimate.p_WF[leg, :2] - to[:2])
        # With the base lowered the place below the hip may be in the ground.
        to[2] = max(to[2], self._watch.safe(leg)[2] + settings.swing_height_m)
        self.motion.raise_leg(leg, now, to)
        if settings.base_reference == "stride":
            self.motion.shift_base(now, self._turn.support_pose, settings.shift_s)
        self._enter(State.LEG_UP, now, reason)

    def _leg_up(self, now: Observation) -> None:
        if now.t < self.reference.swing_t1:
            return
        if self._turn.no_way_back:
            self._rest(now, self._turn.no_way_back)
        elif self._freed:
            self._ask(now, f"{LEGS[self._turn.leg]} is free of the ground that gave way")
        else:
            self._next_candidate(now)

    def _next_candidate(self, now: Observation) -> None:
        """The next alternative, or back to the last safe foothold when there is none."""
        self._turn.candidate += 1
        self._turn.around = 0
        if not self.motion.in_air:
            self.motion.plant(now)  # the swing that was planned must not begin
        if self._turn.candidate < len(self._turn.candidates_W):
            self._ask(now, f"alternative {self._turn.candidate} of {len(self._turn.candidates_W) - 1}")
            return
        self._course.put_off(self._turn.leg)
        if self.motion.in_air:
            self._return_safe(now, _NO_FOOTHOLD)
        else:
            self._returned(now, _NO_FOOTHOLD)

    def _return_safe(self, now: Observation, reason: str) -> None:
        """The leg goes back to where it stood; a foot that presses is unloaded first, and the MPC knows ahead.

        A foot that leaves the ground under load throws the base over.
        """
        settings, leg, safe_W = self._settings, self._turn.leg, self._watch.safe(self._turn.leg)
        if self.motion.in_air:
            self._plan_swing(now.t, safe_W, now)
            self.motion.lift_off(now, settings.swing_s)
        else:
            normal = self.reference.normal_W
            forces = np.array([now.normal_force(leg) * normal, settings.unload_n * normal])
            self.motion.press(leg, now.t, forces)
            self._plan_swing(now.t + settings.unload_s, safe_W, now)
        self._enter(State.RETURN_SAFE, now, reason)

    def _go_back(self, now: Observation) -> None:
        if self.motion.in_air:
            self._detect_contact(now)
        elif now.t >= self.reference.swing_t0:
            self.motion.lift_off(now, self._settings.swing_s)

    def _returned(self, now: Observation, reason: str) -> None:
        """The leg is back: stop as was asked, or go on with a leg whose ground has given way."""
        self.motion.plant(now)
        waiting = self._course.waiting
        if waiting and not self._turn.halt:
            self._enter(State.PRE_OPT, now, f"{LEGS[waiting[0]]} lost its foothold")
        elif self._may_put_off and not self._turn.halt:
            self._enter(State.PRE_OPT, now, f"{reason}: {LEGS[self._turn.leg]} is put off")
        else:
            self._rest(now, self._turn.halt or reason)

    @property
    def _may_put_off(self) -> bool:
        """Another leg may move first: this one stands on ground that has borne it before."""
        return self._settings.put_off and self._course.stuck and bool(self.motion.grounded.all())

    def _rest(self, now: Observation, reason: str) -> None:
        """STOPPED until a new direction is commanded: on four feet, or on three with the leg in the air."""
        if self.motion.in_air:
            self._turn.rest()
            self._enter(State.STOPPED, now, reason)
        else:
            self.stand(now, reason)
        self._report("stopped", reason)

    # Stance feet and balance ----------------------------------------------------------------------------

    def _watch_stance(self, now: Observation) -> None:
        """A foot that sinks or slips after it was trusted is a collapse too: it is the next to be moved."""
        watched = self.motion.bearing
        if self.state in (State.PROBE, State.RETURN_SAFE) and self._turn.leg >= 0:
            watched[self._turn.leg] = False  # `_probe` judges it, or it is on its way
        moved = self._watch.displacement(now.estimate.p_WF)
        for leg in np.flatnonzero(watched & (moved > self._settings.collapse_m)):
            self._gave_way(int(leg), float(moved[leg]), now)

    def _gave_way(self, leg: int, moved: float, now: Observation) -> None:
        foot, borne_n = now.estimate.p_WF[leg], float(self._watch.borne_n[leg])
        why = f"{LEGS[leg]} moved {1e2 * moved:.1f} cm after it was accepted"
        self._report("late_collapse", why, leg=leg, p_WF=foot.copy(), displacement_m=moved, held_n=borne_n)
        self._watch.sunk[leg] |= self.motion.trusted[leg]
        self.motion.distrust(leg, now)
        self._course.put_first(leg)
        if self.motion.in_air:
            if self.state == State.STOPPED:
                self._turn.halt = why
            if self.state != State.RETURN_SAFE:
                self._return_safe(now, why)
        elif self.state == State.STOPPED:
            self.stand(now, why)
        elif self.state == State.PROBE:
            # To lift this foot too would leave two; the base stays, as without the press little is left to bear.
            self._stay(now, f"{LEGS[leg]} gave way under the press")
        elif self.state != State.RETURN_SAFE:
            self.motion.plant(now)
            self._enter(State.PRE_OPT, now, why)
            self._leave(leg, now)

    def _leave(self, leg: int, now: Observation) -> None:
        """The base sets off from a foot that sinks without waiting for a plan."""
        feet, normal = now.estimate.p_WF, now.estimate.normal_W
        pose = self._planner.support_pose(
            leg, feet[leg], feet, normal, self._course.heading, now.com_B, np.zeros(3)
        )
        if pose is not None:
            self.motion.shift_base(now, pose, self._settings.shift_s)

    def _free_sunk(self, now: Observation) -> None:
        """A foot on ground that gives way is lifted as soon as the others can carry, or when it carries nothing.

        Who goes on counting on a foot that hangs in a hole loses the balance that the others could keep.
        """
        leg = self._turn.leg
        if (
            self.state not in (State.SEND, State.OPT, State.MOVE)
            or self.motion.in_air
            or not self.motion.sinking[leg]
        ):
            return
        if self._balance.inside(now, self.reference, leg) or not now.estimate.contact[leg]:
            self._begin_leg_up(now, f"{LEGS[leg]} leaves the ground that gave way", freed=True)

    def _watch_balance(self, now: Observation) -> None:
        """A base that tilts or leaves the support triangle while a leg is moved ends the step."""
        resting = self.state in (State.RETURN_SAFE, State.STOPPED)
        if self.state != State.PROBE and (resting or not self.motion.in_air):
            return
        why = self._balance.lost(now, self.reference, self._turn.leg)
        if not why:
            return
        self._event("rejected", why, now, now.estimate.p_WF[self._turn.leg])
        if self.motion.in_air:
            self._turn.halt = why
            self._return_safe(now, why)
        else:
            self.motion.plant(now)
            self._rest(now, why)

    # ----------------------------------------------------------------------------------------------------

    @property
    def _force_max_n(self) -> np.ndarray:
        """(4,) what each foothold is certified for [N]; 0, no cap, under test, in the air or sinking.

        While a foot presses there is no cap: the foot across bears that press and (W m)/h more, whatever it is
        certified for.
        """
        return self._certificates.caps_n(self.motion.trusted & (self.state != State.PROBE))

    def _footing(self, now: Observation) -> np.ndarray:
        """(4, 3) the feet, with one that is in the air at its safe foothold."""
        feet = now.estimate.p_WF.copy()
        if self.motion.in_air:
            feet[self._turn.leg] = self._watch.safe(self._turn.leg)
        return feet

    def _feet_now(self, now: Observation) -> np.ndarray:
        """(4, 3) where the plan starts from: the feet that stand, and the one in the air where it is."""
        feet = self.reference.p_WF.copy()
        if self.motion.in_air:
            feet[self._turn.leg] = now.estimate.p_WF[self._turn.leg]
        return feet

    def _enter(self, state: State, now: Observation, reason: str) -> None:
        self.state, self.reason, self._entered = state, reason, now.t
        self._report("transition", reason, leg=self._turn.leg)

    def _event(self, kind: str, reason: str, now: Observation, p_WF: np.ndarray, **figures) -> None:
        self._report(kind, reason, leg=self._turn.leg, p_WF=p_WF.copy(), **figures)
