"""What became of each candidate of a leg's turn: the force it held, how far the foot moved, the verdict."""

from __future__ import annotations

from dataclasses import dataclass, field

from surefoot.bus.messages import FsmEvent
from surefoot.components.fsm.state import State

_OVER = (State.PRE_OPT, State.RETURN_SAFE, State.STOPPED)


@dataclass
class Candidate:
    """One foothold that was tried, or is being tried.

    Attributes:
        number: 0 the planned one, 1.. the alternatives.
        asked_n: the largest normal force that was asked of it [N].
        held_n: the largest that it held [N].
        displacement_m: the farthest that the foot moved on it [m].
        verdict: in words; empty as long as there is none.
        accepted: it bears.
    """

    number: int
    asked_n: float = 0.0
    held_n: float = 0.0
    displacement_m: float = 0.0
    verdict: str = ""
    accepted: bool = False


@dataclass
class Turn:
    """A leg's candidates, in the order in which they were tried.

    Attributes:
        leg: 0..3.
        candidates: those that were tried.
        end: why the turn is over; empty as long as it lasts.
    """

    leg: int
    candidates: list[Candidate] = field(default_factory=list)
    end: str = ""

    @property
    def accepted(self) -> bool:
        """The leg has found a foothold."""
        return any(each.accepted for each in self.candidates)

    def candidate(self, number: int) -> Candidate:
        """The one of that number; a new one if it was not tried before."""
        for each in self.candidates:
            if each.number == number:
                return each
        self.candidates.append(Candidate(number))
        return self.candidates[-1]


class Candidates:
    """Reads `fsm/event`.

    Attributes:
        turn: of the leg under way, or the last; None before the first.
        given_up: the last turn that ended without a foothold; None while there was none.
    """

    def __init__(self) -> None:
        self.turn: Turn | None = None
        self.given_up: Turn | None = None

    def note(self, event: FsmEvent) -> None:
        """Take in an event."""
        if event.kind == "transition":
            self._follow(event)
        elif self.turn is not None and not self.turn.end and event.leg == self.turn.leg:
            _judge(self.turn.candidate(event.candidate), event)

    def _follow(self, event: FsmEvent) -> None:
        turn = self.turn
        if event.state == State.SEND and event.leg >= 0:
            if turn is None or turn.end or turn.leg != event.leg:
                self.turn = turn = Turn(event.leg)
            turn.candidate(event.candidate)
        elif event.state in _OVER and turn is not None and not turn.end:
            turn.end = event.reason
            if not turn.accepted:
                self.given_up = turn


def _judge(candidate: Candidate, event: FsmEvent) -> None:
    candidate.displacement_m = max(candidate.displacement_m, event.displacement_m)
    where = f" at point {event.around} around it" if 1 <= event.around <= 4 else ""
    match event.kind:
        case "force_held":
            candidate.asked_n = max(candidate.asked_n, event.asked_n)
            candidate.held_n = max(candidate.held_n, event.held_n)
        case "collapse":
            candidate.asked_n = max(candidate.asked_n, event.asked_n)
            candidate.verdict = f"collapsed{where}: {event.reason}"
        case "rejected":
            candidate.verdict = f"given up{where}: {event.reason}"
        case "accepted":
            candidate.held_n = max(candidate.held_n, event.held_n)
            candidate.verdict, candidate.accepted = f"accepted: {event.reason}", True
