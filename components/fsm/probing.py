"""PROBE and PROBE_AROUND of Fig. 6 (Sec. II-D.5): a foothold bears its forces and is accepted, or gives way."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np

from surefoot.bus.messages import LegStatus
from surefoot.components.fsm.arrow import Arrow
from surefoot.components.fsm.certificates import Certificates
from surefoot.components.fsm.course import AROUND_POINTS, Course
from surefoot.components.fsm.leg_swing import LegSwing
from surefoot.components.fsm.leg_turn import LegTurn
from surefoot.components.fsm.motion import Motion
from surefoot.components.fsm.observation import Observation
from surefoot.components.fsm.probe import Held, Probe, peak_n
from surefoot.components.fsm.stance_watch import StanceWatch
from surefoot.components.fsm.state import State
from surefoot.components.fsm.static_limit import static_limit
from surefoot.components.memory import Memory
from surefoot.config.fsm import Fsm
from surefoot.config.robot import GRAVITY, LEGS, Robot

SKIPPED = "skipped by command"
"""Why a foothold is given up that has not failed."""


class Probing:
    """The test of the foothold that the leg whose turn it is has reached, and of the points around it."""

    memory = Memory("_repeated", "_eased", "_moved_before", "_borne_n", "_borne_m", _press=Probe)

    def __init__(
        self,
        robot: Robot,
        settings: Fsm,
        course: Course,
        watch: StanceWatch,
        certificates: Certificates,
        swing: LegSwing,
        motion: Motion,
        turn: LegTurn,
        event: Callable[..., None],
    ):
        """`event(kind, reason, p_WF, **figures)` reports what a foothold bears."""
        self._settings, self._course, self._watch, self._swing = settings, course, watch, swing
        self._certificates, self._motion, self._turn, self._event = certificates, motion, turn, event
        self._weight_n, self._foot_radius_m = robot.mass * GRAVITY, robot.foot.radius
        self._press = Probe(settings)
        self._repeated = False
        self._eased = ""  # why the press is broken off
        self._moved_before = np.zeros(4)
        self._borne_n = self._borne_m = 0.0  # largest force this candidate has held, displacement under it

    @property
    def force_index(self) -> int:
        """Which of the six forces is applied."""
        return min(self._press.told, len(self._press.asked_W) - 1)

    def contact(self, now: Observation) -> Arrow:
        """The ground is found: whether it is probed here, known to bear, or at an edge."""
        settings, turn, foot = self._settings, self._turn, now.estimate.p_WF[self._turn.leg]
        self._repeated = False
        if not turn.around:
            self._borne_n = self._borne_m = 0.0
        self._motion.touch_down(now, LegStatus.PROBING if settings.probing else LegStatus.STANCE)
        if not settings.probing:
            return self._accept(now, "contact; probing is off")
        if turn.around > AROUND_POINTS:
            return self._accept(now, "all forces were borne here and around")
        known = "" if turn.around else self._known_to_bear(foot)
        if known:
            self._borne_n = float(turn.answer.held_n[turn.leg])
            return self._accept(now, known)
        if turn.around and self._drop(foot) > settings.around_drop_m:
            why = f"the ground beside the foothold lies {1e2 * self._drop(foot):.1f} cm lower"
            self._event("rejected", why, foot)
            return Arrow(State.LEG_UP, why)
        return self._begin_press(now)

    def probe(self, now: Observation) -> Arrow | None:
        """PROBE: every force is held, or the foot moves too far, or the press is broken off."""
        settings, press, reference = self._settings, self._press, self._motion.reference
        leg, normal = self._turn.leg, reference.normal_W
        moved = float(self._watch.displacement(now.estimate.p_WF)[leg])
        if moved > settings.collapse_m:
            return self._collapsed(now, moved)
        if self._eased:
            return self._unloaded(now) if now.t >= reference.probe_t0 + settings.unload_s else None
        for held in press.update(now.t, now.normal_force(leg), normal):
            self._force_held(now, held, moved)
        self._ease_for_others(now)
        if self._eased or not press.over:
            return None
        if press.short(normal) and not self._repeated:
            self._repeated = True
            return self._begin_press(now)
        if not settings.probe_around:
            return self._accept(now, "all forces were borne")
        return self._next_point(now) if now.t >= reference.swing_t0 - 1e-9 else None

    @property
    def ends(self) -> str:
        """Why the press is being broken off, or ""."""
        return self._eased

    def press_again(self, now: Observation) -> Arrow:
        """The foot presses once more, from its first force."""
        self._repeated = False
        return self._begin_press(now)

    def skip(self, now: Observation) -> None:
        """The foothold is given up: the foot is unloaded, then lifted."""
        self._eased = SKIPPED
        self._motion.ease(self._turn.leg, now, self._settings.unload_n)

    def _unloaded(self, now: Observation) -> Arrow:
        """The press that was broken off is over: the foot leaves a foothold that is given up, or stays."""
        if self._eased != SKIPPED:
            return self.stay(now, self._eased)
        self._event("rejected", SKIPPED, now.estimate.p_WF[self._turn.leg])
        return Arrow(State.LEG_UP, SKIPPED)

    def stay(self, now: Observation, why: str) -> Arrow:
        """The press was broken off: the foot stays, certified for what it has borne, or to be probed again."""
        if self._borne_n > 0.0:
            return self._accept(now, why)
        self._course.put_first(self._turn.leg)
        self._motion.plant(now)
        return Arrow(State.PRE_OPT, why)

    def _begin_press(self, now: Observation) -> Arrow:
        """Eq. (6): every force of the envelope for 100 ms, from the force that is there now.

        Where the foot is to hop on afterwards, it is unloaded first, and the MPC knows of the hop from the
        start: a foot that leaves the ground under full load throws the base over.
        """
        settings, press, turn, motion = self._settings, self._press, self._turn, self._motion
        normal = motion.reference.normal_W
        inside = settings.margin_m + settings.margin_extra_m
        limit = static_limit(motion.reference.p_WF, turn.leg, inside, self._weight_n)
        press.ask(turn.envelope_W, settings.force_over_static * limit, normal)
        forces = [max(now.normal_force(turn.leg), 5.0) * normal, *press.asked_W]
        begin = now.t + settings.settle_s
        if settings.probe_around:
            forces.append(settings.unload_n * normal)
            if turn.around == 0:
                turn.foothold_W = now.estimate.p_WF[turn.leg].copy()
            point = self._course.around(turn.foothold_W, turn.around + 1)
            self._swing.plan_hop(begin + press.duration_s + settings.unload_s, point, now)
        self._eased = ""
        self._moved_before = self._watch.displacement(now.estimate.p_WF)
        motion.press(turn.leg, begin, np.array(forces))
        press.begin(begin)
        where = f"around point {turn.around}" if turn.around else "foothold"
        where += ", again: the force fell short" if self._repeated else ""
        peak, needed = peak_n(press.asked_W, normal), peak_n(turn.envelope_W, normal)
        short = f" of {needed:.0f}, statics allow no more" if peak < needed - 0.5 else ""
        return Arrow(State.PROBE, f"{where}, up to {peak:.0f} N{short}")

    def _force_held(self, now: Observation, held: Held, moved: float) -> None:
        if not self._turn.around and held.held_n > self._borne_n:
            self._borne_n, self._borne_m = held.held_n, moved
        short = "" if held.enough else ", short of the asked force"
        self._event(
            "force_held",
            f"{held.held_n:.0f} of {held.asked_n:.0f} N{short}",
            now.estimate.p_WF[self._turn.leg],
            force_index=held.index,
            asked_n=held.asked_n,
            held_n=held.held_n,
            displacement_m=moved,
        )

    def _ease_for_others(self, now: Observation) -> None:
        """A stance foot yields under what another presses: the press ends before it is a collapse.

        The opposite foot bears the press and its own share, more than it was probed with. Without the press it
        has less than half of that; it is the next to be moved.
        """
        further = self._watch.displacement(now.estimate.p_WF) - self._moved_before
        moved = np.where(self._motion.trusted, further, 0.0)
        worst = int(np.argmax(moved))
        if moved[worst] > self._settings.yield_m:
            self._eased = f"{LEGS[worst]} yielded {1e2 * moved[worst]:.1f} cm under the press"
            self._course.put_first(worst)
            self._motion.ease(self._turn.leg, now, self._settings.unload_n)

    def _collapsed(self, now: Observation, moved: float) -> Arrow:
        why = f"the foot moved {1e2 * moved:.1f} cm, limit {1e2 * self._settings.collapse_m:.1f} cm"
        index, foot = self.force_index, now.estimate.p_WF[self._turn.leg]
        asked = self._press.asked_n(index, self._motion.reference.normal_W)
        self._event("collapse", why, foot, force_index=index, asked_n=asked, displacement_m=moved)
        return Arrow(State.LEG_UP, why)

    def _next_point(self, now: Observation) -> Arrow:
        """PROBE_AROUND: front, back, left, right of the foothold, then back to its centre."""
        turn = self._turn
        turn.around += 1
        self._motion.lift_off(now, self._settings.hop_s)
        back = turn.around > AROUND_POINTS
        what = "back to the foothold" if back else f"point {turn.around} around the foothold"
        return Arrow(State.PROBE_AROUND, what)

    def _accept(self, now: Observation, reason: str) -> Arrow:
        """The foothold is safe: only now does it replace the old one."""
        leg, foot, given = self._turn.leg, now.estimate.p_WF[self._turn.leg], self._certificates
        self._watch.trust(leg, foot)
        self._motion.trust(leg)
        self._course.settle(leg)
        self._motion.plant(now)
        if self._settings.probing:
            given.give(leg, self._borne_n, self._borne_m)
            peak = peak_n(self._turn.envelope_W, self._motion.reference.normal_W)
            if self._borne_n < self._settings.held_share * peak:
                reason = f"{reason}; certified for {self._borne_n:.0f} of {peak:.0f} N only"
        held_n, moved = float(given.held_n[leg]), float(given.displaced_m[leg])
        self._event("accepted", reason, foot, held_n=held_n, displacement_m=moved)
        return Arrow(State.PRE_OPT, f"{LEGS[leg]} stands safely")

    def _known_to_bear(self, foot_W: np.ndarray) -> str:
        """Why a foothold need not be probed, or "": the map knows this very spot to bear what the stride needs."""
        turn, settings = self._turn, self._settings
        held_n = float(turn.answer.held_n[turn.leg])
        needed = peak_n(turn.envelope_W, self._motion.reference.normal_W)
        off = float(np.linalg.norm(foot_W - turn.answer.foothold_WF[turn.leg]))
        if not settings.adaptive_probing or held_n <= 0.0 or held_n < needed or off > self._foot_radius_m:
            return ""
        return f"known to bear {held_n:.0f} N of {needed:.0f} N needed, {1e3 * off:.0f} mm away: not probed again"

    def _drop(self, foot_W: np.ndarray) -> float:
        """How much lower a point around it is than the foothold, along the normal [m]."""
        return float((self._turn.foothold_W - foot_W) @ self._motion.reference.normal_W)
