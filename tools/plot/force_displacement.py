"""Force against displacement: how the ground under a foot yields while it is pressed."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np

from surefoot.bus.topics import TOPICS
from surefoot.config.robot import LEGS
from surefoot.tools.plot.choice import Choice
from surefoot.tools.plot.probes import Press, Probe
from surefoot.tools.plot.verdict_looks import COLORS
from surefoot.tools.reproduce.plots import Axes, Figure, new_figure, normal_component
from surefoot.tools.tables.recording_tables import RecordingTables
from surefoot.tools.tables.table import NotRecorded, Table

_NAMED = 6  # curves that are few enough for a name each
_SMOOTHED_S = 0.03
_COLORS = {"held": COLORS["accepted"], "gave way": COLORS["collapse"], "broken off": COLORS["broken off"]}


def displacement(recording: RecordingTables, choice: Choice) -> Figure:
    """The chosen probes, one curve for each press."""
    probes = [probe for probe in choice.probes(recording) if probe.presses]
    if not probes:
        raise NotRecorded("no foot has pressed in what was chosen")
    figure = new_figure(7.0, 4.6)
    draw_curves(figure.add_subplot(), recording, probes)
    return figure


def draw_curves(axes: Axes, recording: RecordingTables, probes: Sequence[Probe]) -> None:
    """Normal force over the displacement of the foot: a few presses each by name, many by what came of them.

    Both are means over `_SMOOTHED_S`: the noise of a foot's position hides where it goes.
    """
    presses = [(probe, press) for probe in probes for press in probe.presses]
    begin, end = min(press.begin_t for _, press in presses), max(press.end_t for _, press in presses)
    estimate = recording.read("state/estimate", ("p_WF", "force_W", "normal_W"), begin, end)
    reference = recording.read("fsm/reference", ("p_WF",), begin, end)
    few, labelled = len(presses) <= _NAMED, set()
    for number, (probe, press) in enumerate(presses):
        outcome = _outcome(probe, press)
        label = f"{_where(probe, press)}: {outcome}" if few else outcome
        color = f"C{number}" if few and outcome == "held" else _COLORS.get(outcome, "#777777")
        bold = few or outcome == "gave way"
        moved_m, force_n = (_smoothed(each, estimate) for each in curve(estimate, reference, probe.leg, press))
        look: Any = {"linewidth": 1.6, "zorder": 3} if bold else {"linewidth": 0.8, "alpha": 0.75}
        axes.plot(1e3 * moved_m, force_n, color=color, label=None if label in labelled else label, **look)
        labelled.add(label)
    limit_mm = 1e3 * recording.deployment.fsm.collapse_m
    axes.axvline(limit_mm, color="#555555", linestyle=":", label=f"a collapse, {limit_mm:.0f} mm")
    axes.set(title="Force against displacement", xlabel="displacement of the foot mm", ylabel="normal force N")
    axes.set_xlim(left=0.0)
    axes.legend(loc="best", fontsize=8.0)


def _outcome(probe: Probe, press: Press) -> str:
    """Of one press: those before the last have held."""
    if press is not probe.presses[-1]:
        return "held"
    return {"accepted": "held", "rejected": "held", "collapse": "gave way"}.get(probe.verdict, probe.verdict)


def _where(probe: Probe, press: Press) -> str:
    point = f", around {press.around}" if press.around else ""
    return f"{LEGS[probe.leg]}, {press.begin_t:.1f} s{point}"


def _smoothed(values: np.ndarray, estimate: Table) -> np.ndarray:
    """(m,) running means of (n,) values at the times of the estimate."""
    width = max(round(_SMOOTHED_S * TOPICS[estimate.key].rate_hz), 1)
    return np.convolve(values, np.full(width, 1.0 / width), "valid") if len(values) >= width else values


def curve(estimate: Table, reference: Table, leg: int, press: Press) -> tuple[np.ndarray, np.ndarray]:
    """Displacement (n,) [m] and normal force (n,) [N] of a foot from the beginning of a press to its end.

    As the state machine sees it: from where the foot touched down, which its reference keeps while the foot
    presses; the median displacement of the other feet is the drift of the estimate.
    """
    rows = np.flatnonzero((estimate.t >= press.begin_t - 1e-9) & (estimate.t <= press.end_t))
    begun = min(int(np.searchsorted(reference.t, press.begin_t - 1e-9)), reference.rows - 1)
    moved = estimate["p_WF"][rows] - reference["p_WF"][begun]
    others = [other for other in range(len(LEGS)) if other != leg]
    drift = np.median(moved[:, others], axis=1)
    force_n = normal_component(estimate["force_W"][rows, leg], estimate["normal_W"][rows])
    return np.linalg.norm(moved[:, leg] - drift, axis=1), force_n
