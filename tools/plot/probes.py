"""The probes of a run, as its state machine told them: which foot, which forces, what came of it."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field

import numpy as np

from surefoot.bus.messages import FsmEvent
from surefoot.config.robot import LEGS
from surefoot.tools.tables.recording_tables import RecordingTables
from surefoot.tools.tables.table import NotRecorded

VERDICTS = ("accepted", "collapse", "rejected", "broken off", "unfinished")
"""What can come of a probe; unfinished: the recording ends before."""

_SHOWN = 12  # probes that an error lists


@dataclass
class Press:
    """One press of the ground: all forces of the envelope, one after the other, or as far as it came.

    Attributes:
        around: 0 the foothold, 1 to 4 the point in front, behind, left, right of it, 5 back on it.
        begin_t, end_t: on the run's clock [s].
        held: an event for each force that was held.
    """

    around: int
    begin_t: float
    end_t: float
    held: list[FsmEvent] = field(default_factory=list)

    @property
    def held_n(self) -> float:
        """Largest normal force that was held [N]; 0 none."""
        return max((event.held_n for event in self.held), default=0.0)


@dataclass
class Probe:
    """A foot's visit to one candidate, from lift-off to the verdict.

    Attributes:
        number: among all of the run, from 1.
        leg, candidate: whose foot; 0 the planned foothold, 1.. the alternatives.
        begin_t, end_t: on the run's clock [s].
        contact_t: when the foot touched the ground at the foothold; NaN if that is not recorded.
        p_WF: (3,) foot centre as it was estimated at contact, or later where that is not recorded [m].
        presses: of the foothold and of points around it.
        verdict: one of `VERDICTS`.
        reason: of the verdict, in the state machine's words.
        certified_n: normal force that the foothold was certified for [N]; 0 none.
        displacement_m: largest of the foot from its contact.
    """

    number: int
    leg: int
    candidate: int
    begin_t: float
    end_t: float
    contact_t: float = np.nan
    p_WF: np.ndarray = field(default_factory=lambda: np.full(3, np.nan))
    presses: list[Press] = field(default_factory=list)
    verdict: str = "unfinished"
    reason: str = ""
    certified_n: float = 0.0
    displacement_m: float = 0.0

    @property
    def held_n(self) -> float:
        """Largest normal force that was held, here or around [N]; 0 none."""
        return max((press.held_n for press in self.presses), default=0.0)

    @property
    def where(self) -> str:
        """Of which candidate, in words."""
        return f"alternative {self.candidate}" if self.candidate else "planned"

    @property
    def around(self) -> int:
        """At which point it ended: as in `Press`."""
        return self.presses[-1].around if self.presses else 0


def find_probes(recording: RecordingTables) -> list[Probe]:
    """All probes of a recording in order.

    Raises:
        NotRecorded: it holds nothing of the state machine.
    """
    if "fsm/event" not in recording:
        raise NotRecorded(f"{recording.path}: no fsm/event in it, so that nothing is known of its probes")
    reader = _Reader(recording.span_s[1])
    for _, event in recording.messages(["fsm/event"]):
        assert isinstance(event, FsmEvent)
        reader.take(event)
    return reader.probes


def choose(probes: Sequence[Probe], leg: int = -1, number: int = 0) -> list[Probe]:
    """Those of a leg, or one of them.

    Args:
        probes: of a recording.
        leg: -1: of all legs.
        number: of the probe among those of the leg, from 1; 0: all.

    Raises:
        NotRecorded: there is none; the message lists what there is.
    """
    of_leg = [probe for probe in probes if leg in (-1, probe.leg)]
    if not of_leg:
        others = sorted({LEGS[probe.leg] for probe in probes})
        there = f"there are probes of {', '.join(others)}" if others else "there are none at all"
        raise NotRecorded(f"no probe of {LEGS[leg] if leg >= 0 else 'any leg'} in this recording; {there}")
    if not number:
        return of_leg
    if not 1 <= number <= len(of_leg):
        told = "; ".join(
            f"{place}: {LEGS[probe.leg]} at {probe.begin_t:.1f} s, {probe.verdict}"
            for place, probe in enumerate(of_leg[:_SHOWN], 1)
        )
        whose = f" of {LEGS[leg]}" if leg >= 0 else ""
        raise NotRecorded(f"no probe {number}{whose} in this recording; there are 1 to {len(of_leg)}: {told}")
    return [of_leg[number - 1]]


class _Reader:
    """Makes probes of events.

    A recording may begin in the middle of one: then its lift-off and its contact are not known.
    """

    def __init__(self, end_t: float):
        self.probes: list[Probe] = []
        self._end_t = end_t
        self._begin_t = end_t  # of what is told
        self._open: Probe | None = None
        self._pressing = False

    def take(self, event: FsmEvent) -> None:
        self._begin_t = min(self._begin_t, event.t)
        if event.kind == "transition":
            self._transition(event)
        elif event.kind == "contact" and self._open is not None and not event.around:
            self._open.contact_t, self._open.p_WF = event.t, event.p_WF
        elif event.kind == "force_held":
            self._press(event).held.append(event)
            self._moved(event)
        elif event.kind in ("collapse", "rejected", "accepted") and (self._open or event.kind != "rejected"):
            probe = self._probe(event)
            probe.certified_n = event.held_n if event.kind == "accepted" else 0.0
            self._moved(event)
            self._end(event, event.kind)

    def _transition(self, event: FsmEvent) -> None:
        self._end_press(event.t)
        if event.state == "DETECT_CONTACT":
            self._end(event, "broken off")
            self._begin(event, event.t)
        elif event.state == "PROBE":
            probe = self._probe(event)
            probe.presses.append(Press(event.around, event.t, self._end_t))
            self._pressing = True
        elif event.state != "PROBE_AROUND":
            self._end(event, "broken off")

    def _begin(self, event: FsmEvent, t: float) -> Probe:
        self._open = Probe(len(self.probes) + 1, event.leg, event.candidate, t, self._end_t)
        self.probes.append(self._open)
        return self._open

    def _probe(self, event: FsmEvent) -> Probe:
        """The one that goes on, or that had begun before the recording."""
        return self._open or self._begin(event, self._begin_t)

    def _press(self, event: FsmEvent) -> Press:
        probe = self._probe(event)
        if not self._pressing:
            probe.presses.append(Press(event.around, self._begin_t, self._end_t))
            self._pressing = True
        return probe.presses[-1]

    def _moved(self, event: FsmEvent) -> None:
        probe = self._probe(event)
        probe.displacement_m = max(probe.displacement_m, event.displacement_m)
        if np.isnan(probe.p_WF).any():
            probe.p_WF = event.p_WF

    def _end_press(self, t: float) -> None:
        if self._open is not None and self._pressing:
            self._open.presses[-1].end_t = t
        self._pressing = False

    def _end(self, event: FsmEvent, verdict: str) -> None:
        if self._open is not None:
            self._end_press(event.t)
            self._open.verdict, self._open.reason, self._open.end_t = verdict, event.reason, event.t
        self._open = None
