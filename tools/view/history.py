"""What the rare messages have told: the places that feet have tried, and the candidates of the leg's turn."""

from __future__ import annotations

from collections import deque
from collections.abc import Callable
from dataclasses import dataclass, field

import numpy as np

from surefoot.bus.message import Message
from surefoot.bus.messages import FootholdRegions, FootholdRequest, FsmEvent, OperatorCommand, Plan, Tuning
from surefoot.components.fsm.course import AROUND_POINTS
from surefoot.components.fsm.state import State
from surefoot.tools.view.palette import Verdict

RARE = (
    *("fsm/event", "foothold/request", "foothold/regions", "trajopt/plan"),
    *("operator/command", "operator/tuning"),
)
"""Topics of which every message counts."""

_SAME_PLACE_M = 0.012  # a foot that comes back stands that near; points around a foothold are twice as far
_EVENTS = 200
_SPOTS = 200


@dataclass
class Spot:
    """A place on which a foot has stood.

    Attributes:
        leg: which.
        p_W: (3,) foot centre [m].
        verdict: on it.
        around: 0 a foothold, 1 to 4 a point around one.
        held_n: largest normal force that it has held; of one that gave way, the force asked then [N].
    """

    leg: int
    p_W: np.ndarray
    verdict: Verdict
    around: int = 0
    held_n: float = 0.0


@dataclass
class Candidate:
    """A foothold that a leg's turn considers.

    Attributes:
        p_W: (3,) foot centre [m].
        outcome: in words what became of it; empty while it is tried.
        verdict: on it.
    """

    p_W: np.ndarray
    outcome: str = ""
    verdict: Verdict = Verdict.UNTESTED


@dataclass
class Press:
    """The forces of one press, by index: asked and held [N], and how far the foot has moved [m]."""

    asked_n: dict[int, float] = field(default_factory=dict)
    held_n: dict[int, float] = field(default_factory=dict)
    displacement_m: float = 0.0


class History:
    """The story so far, told message by message.

    Attributes:
        spots: every place that was tried, oldest first.
        leg: whose turn it is or was last; -1 nobody's yet.
        candidates: of that turn, by number; those that were not tried yet are not on the bus.
        plan: of the stride to the candidate of the moment, with its envelope of forces; None while there is none.
        press: of the present or the last contact.
        touch_W: (3,) where the foot of that leg has met the ground; None while it is in the air.
        events: the newest, oldest first.
        command: what the robot was told last.
        tunings: the newest changes of the settings, oldest first.
        count: of messages that were told.
    """

    def __init__(self) -> None:
        self.spots: deque[Spot] = deque(maxlen=_SPOTS)
        self.leg = -1
        self.candidates: dict[int, Candidate] = {}
        self.plan: Plan | None = None
        self.press = Press()
        self.touch_W: np.ndarray | None = None
        self.events: deque[FsmEvent] = deque(maxlen=_EVENTS)
        self.command = ""
        self.tunings: deque[Tuning] = deque(maxlen=_EVENTS)
        self.count = 0
        self._number = 0
        self._stands: Spot | None = None

    def note(self, message: Message) -> None:
        """Take in one message; all of them in the order of their times."""
        self.count += 1
        match message:
            case FsmEvent():
                self._note_event(message)
            case FootholdRequest() if self.leg >= 0:
                self._propose(message.target_WF[self.leg])
            case FootholdRegions() if self.leg >= 0:
                self._propose(message.foothold_WF[self.leg])
            case Plan():
                self.plan = message
                if self.leg >= 0 and message.status == "ok":
                    self._propose(message.footholds_WF[self.leg])
            case OperatorCommand():
                self.command = message.command
            case Tuning() if message.assignment:
                self.tunings.append(message)

    def _note_event(self, event: FsmEvent) -> None:
        self.events.append(event)
        if event.kind == "transition":
            self._enter(event)
        elif event.kind == "late_collapse":
            spot = self._spot(event)
            spot.verdict, spot.held_n = Verdict.COLLAPSED, event.held_n
        elif (told := _OF_TURN.get(event.kind)) is not None:
            told(self, event)

    def _enter(self, event: FsmEvent) -> None:
        """A new turn forgets the candidates of the last; a leg that is lifted has no contact."""
        if event.state == State.SEND:
            if event.leg != self.leg or event.candidate == 0:
                self.leg, self.candidates, self._stands = event.leg, {}, None
            self._number, self.plan = event.candidate, None
        elif event.state in (State.MOVE, State.DETECT_CONTACT, State.LEG_UP, State.RETURN_SAFE):
            self.touch_W = None

    def _contact(self, event: FsmEvent) -> None:
        """The foot stands: from here on what is told of it is told of this place."""
        self.touch_W, self.press = event.p_WF, Press()
        last, self._stands = self._stands, self._spot(event)
        if event.around and last is not None and last.verdict == Verdict.PROBING:
            last.verdict = Verdict.HELD  # the foot has hopped on: the place bore all that was asked
        if event.around <= AROUND_POINTS and event.state != State.RETURN_SAFE:
            self._stands.verdict, self._stands.held_n = Verdict.PROBING, 0.0
        self._judge(event, Verdict.PROBING, "")

    def _force_held(self, event: FsmEvent) -> None:
        press, spot = self.press, self._stands or self._spot(event)
        press.asked_n[event.force_index], press.held_n[event.force_index] = event.asked_n, event.held_n
        press.displacement_m = max(press.displacement_m, event.displacement_m)
        spot.held_n = max(spot.held_n, event.held_n)
        self._judge(event, Verdict.PROBING, "")

    def _collapse(self, event: FsmEvent) -> None:
        press, spot = self.press, self._stands or self._spot(event)
        press.asked_n[event.force_index], press.displacement_m = event.asked_n, event.displacement_m
        spot.verdict, spot.held_n = Verdict.COLLAPSED, event.asked_n
        self._judge(event, Verdict.COLLAPSED, event.reason)

    def _accepted(self, event: FsmEvent) -> None:
        spot = self._spot(event)
        spot.held_n = max(spot.held_n, event.held_n)
        spot.verdict = (
            Verdict.HELD if spot.held_n > 0.0 else Verdict.UNTESTED
        )  # without probing it is only trusted
        self._judge(event, spot.verdict, event.reason)

    def _rejected(self, event: FsmEvent) -> None:
        self._judge(event, Verdict.REJECTED, event.reason)
        if event.around and self._stands is not None:
            self._stands.verdict = Verdict.REJECTED  # a point around the foothold lies too low

    def _judge(self, event: FsmEvent, verdict: Verdict, why: str) -> None:
        if event.leg != self.leg:  # nobody has listened as its turn began
            self.leg, self.candidates, self._number = event.leg, {}, event.candidate
        candidate = self.candidates.setdefault(event.candidate, Candidate(event.p_WF))
        candidate.verdict, candidate.outcome = verdict, why

    def _propose(self, p_W: np.ndarray) -> None:
        """The candidate of the moment lies here, as far as it is known by now."""
        candidate = self.candidates.setdefault(self._number, Candidate(p_W))
        if candidate.verdict == Verdict.UNTESTED:
            candidate.p_W = p_W

    def _spot(self, event: FsmEvent) -> Spot:
        """The place of an event: one on which the leg has stood before, seen from above, or a new one."""
        for spot in reversed(self.spots):
            if spot.leg == event.leg and float(np.hypot(*(spot.p_W - event.p_WF)[:2])) < _SAME_PLACE_M:
                return spot
        spot = Spot(event.leg, event.p_WF, Verdict.PROBING, event.around)
        self.spots.append(spot)
        return spot


_OF_TURN: dict[str, Callable[[History, FsmEvent], None]] = {
    "contact": History._contact,
    "force_held": History._force_held,
    "collapse": History._collapse,
    "accepted": History._accepted,
    "rejected": History._rejected,
}
