"""The time line of a run: states of the machine, the leg whose turn it is, and what happened."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from surefoot.bus.messages import FsmEvent
from surefoot.config.robot import LEGS
from surefoot.tools.plot.choice import Choice
from surefoot.tools.plot.verdict_looks import COLORS, MARKS, OTHER_STATE, STATES
from surefoot.tools.reproduce.plots import Axes, Figure, new_figure
from surefoot.tools.tables.recording_tables import RecordingTables
from surefoot.tools.tables.table import NotRecorded

_LINE_S = 90.0  # of the run in one row of the picture
_MOST_LINES = 12
_GAP = 0.0015  # between the turns of two legs, of all that is drawn

_TOLD = {"accepted": "accepted", "collapse": "collapse", "late_collapse": "collapse", "rejected": "rejected"}
"""Kinds of events that are marked, and the verdict whose look they have."""


@dataclass(frozen=True)
class Stretch:
    """A time in which the machine is in one state.

    Attributes:
        state: of Fig. 6, or a posture.
        begin_t, end_t: on the run's clock [s].
        leg: whose turn it is; -1 none's.
        reason: why it was entered.
    """

    state: str
    begin_t: float
    end_t: float
    leg: int
    reason: str


def stretches(
    recording: RecordingTables, begin_s: float = float("-inf"), end_s: float = float("inf")
) -> list[Stretch]:
    """The states of the machine in order.

    Raises:
        NotRecorded: nothing of the state machine was recorded.
    """
    reference = recording.read("fsm/reference", ("state", "reason", "leg"), begin_s, end_s)
    if not reference.rows:
        raise NotRecorded(f"{recording.path}: no fsm/reference between {begin_s:.1f} and {end_s:.1f} s")
    state, leg = reference["state"], reference["leg"]
    begins = np.flatnonzero(np.r_[True, (state[1:] != state[:-1]) | (leg[1:] != leg[:-1])])
    ends = np.r_[reference.t[begins[1:]], reference.t[-1]]
    return [
        Stretch(state[row], float(reference.t[row]), float(end), int(leg[row]), reference["reason"][row])
        for row, end in zip(begins, ends, strict=True)
    ]


def time_line(recording: RecordingTables, choice: Choice) -> Figure:
    """States and events over the run, in rows as long as a page is wide."""
    begin, end = recording.span_s
    if choice.number:
        (probe,) = choice.probes(recording)
        begin, end = probe.begin_t, probe.end_t
    found = [each for each in stretches(recording, begin, end) if choice.leg in (-1, each.leg)]
    if not found:
        raise NotRecorded(f"{recording.path}: {LEGS[choice.leg]} is never moved in it")
    begin, end = found[0].begin_t, found[-1].end_t
    lines = min(max(int(np.ceil((end - begin) / _LINE_S)), 1), _MOST_LINES)
    length = max(end - begin, 1e-3) / lines
    figure = new_figure(10.0, 0.9 + 0.95 * lines)
    rows = figure.subplots(lines, 1, squeeze=False)[:, 0]
    told = [event for _, event in recording.messages(["fsm/event"], begin, end) if isinstance(event, FsmEvent)]
    events = [event for event in told if choice.leg in (-1, event.leg)]
    for number, axes in enumerate(rows):
        first = begin + number * length
        state_row(axes, found)
        _mark(axes, events)
        axes.set_xlim(first, first + length)
    rows[-1].set_xlabel("time s")
    _legend(figure, rows[0], found)
    return figure


def state_row(axes: Axes, shown: list[Stretch]) -> None:
    """A bar of states, and above it the leg whose turn it is."""
    for each in shown:
        width = each.end_t - each.begin_t
        axes.broken_barh([(each.begin_t, width)], (0.0, 1.0), facecolor=STATES.get(each.state, OTHER_STATE))
    gap = _GAP * (shown[-1].end_t - shown[0].begin_t)
    for leg, begin, end in _turns(shown):
        axes.plot([begin + gap, end - gap], [1.25, 1.25], color="#1c3d6e", linewidth=1.0, solid_capstyle="butt")
        axes.text(0.5 * (begin + end), 1.32, LEGS[leg], ha="center", va="bottom", fontsize=7.5, clip_on=True)
    axes.set(ylim=(0.0, 2.1), yticks=[])
    axes.grid(visible=False)
    axes.spines["left"].set_visible(False)


def _turns(shown: list[Stretch]) -> list[tuple[int, float, float]]:
    """(leg, begin, end) of the turn of each leg [s]."""
    found: list[tuple[int, float, float]] = []
    for each in shown:
        if each.leg < 0:
            continue
        if found and found[-1][0] == each.leg and each.begin_t - found[-1][2] < 1e-6:
            found[-1] = (each.leg, found[-1][1], each.end_t)
        else:
            found.append((each.leg, each.begin_t, each.end_t))
    return found


def _mark(axes: Axes, events: list[FsmEvent]) -> None:
    for event in events:
        if event.kind in _TOLD:
            verdict = _TOLD[event.kind]
            axes.plot(
                event.t,
                0.5,
                MARKS[verdict],
                color=COLORS[verdict],
                markeredgecolor="white",
                markersize=7,
                clip_on=True,
            )


def _legend(figure: Figure, axes: Axes, shown: list[Stretch]) -> None:
    there = {each.state for each in shown}
    for state in [state for state in STATES if state in there] + sorted(there - STATES.keys()):
        axes.broken_barh([(np.nan, 0.0)], (0.0, 0.0), facecolor=STATES.get(state, OTHER_STATE), label=state)
    for verdict in ("accepted", "collapse", "rejected"):
        axes.plot([], [], MARKS[verdict], color=COLORS[verdict], markeredgecolor="white", label=verdict)
    handles, labels = axes.get_legend_handles_labels()
    figure.legend(handles, labels, loc="outside upper center", ncols=7, fontsize=7.5)
