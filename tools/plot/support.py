"""The support margin over a run: how far the centre of mass lies inside the feet that carry."""

from __future__ import annotations

import numpy as np

from surefoot.components.fsm.support_triangle import SupportTriangle
from surefoot.config.robot import LEGS
from surefoot.tools.picture import SupportMargin
from surefoot.tools.plot.choice import Choice
from surefoot.tools.plot.time_line import state_row, stretches
from surefoot.tools.reproduce.plots import COM, Figure, new_figure
from surefoot.tools.tables.recording_tables import RecordingTables
from surefoot.tools.tables.table import NotRecorded

_STEP_S = 0.02  # what is drawn of a run
_ON_THE_WAY = ("DETECT_CONTACT", "PROBE", "PROBE_AROUND", "LEG_UP")
"""States in which a foot is in the air or presses, so that three carry."""


def support(recording: RecordingTables, choice: Choice) -> Figure:
    """Margin over time, for the chosen leg or probe; the truth where it is recorded, otherwise the estimate."""
    begin, end = recording.span_s
    if choice.number:
        (probe,) = choice.probes(recording)
        begin, end = probe.begin_t, probe.end_t
    t, leg, margin_m = margins(recording, begin, end)
    if choice.leg >= 0:
        margin_m = np.where(leg == choice.leg, margin_m, np.nan)
    if not np.isfinite(margin_m).any():
        whose = f" {LEGS[choice.leg]}" if choice.leg >= 0 else ""
        raise NotRecorded(f"{recording.path}: no time in it in which a foot{whose} is in the air or presses")
    figure = new_figure(10.0, 3.6)
    upper, lower = figure.subplots(2, 1, height_ratios=[5.0, 1.0], sharex=True)
    upper.plot(t, 1e3 * margin_m, color=COM, linewidth=1.1, label="centre of mass to the nearest edge")
    asked = 1e3 * recording.deployment.fsm.margin_m
    upper.axhline(asked, color="#888888", linestyle=":", label=f"margin of eq. (5), {asked:.0f} mm")
    upper.axhline(0.0, color="#888888", linewidth=0.8)
    least = int(np.nanargmin(margin_m))
    upper.plot(t[least], 1e3 * margin_m[least], "o", color=COM)
    upper.annotate(
        f"least: {1e3 * margin_m[least]:.0f} mm, {LEGS[leg[least]]}",
        (t[least], 1e3 * margin_m[least]),
        xytext=(0, -12),
        textcoords="offset points",
        ha="right" if t[least] > 0.5 * (begin + end) else "left",
    )
    source = "truth" if "sim/truth" in recording else "estimate"
    upper.set(title=f"Support margin while three feet carry ({source})", ylabel="mm")
    handles, labels = upper.get_legend_handles_labels()
    figure.legend(handles, labels, loc="outside upper center", ncols=2)
    state_row(lower, stretches(recording, begin, end))
    lower.set(xlabel="time s", xlim=(begin, end))
    return figure


def margins(recording: RecordingTables, begin_s: float, end_s: float) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Time (n,) [s], the leg that is moved or probed (n,), and the margin (n,) [m]; NaN while four feet carry."""
    reference = recording.read("fsm/reference", ("state", "leg"), begin_s, end_s)
    if not reference.rows:
        raise NotRecorded(f"{recording.path}: no fsm/reference between {begin_s:.1f} and {end_s:.1f} s")
    t = np.arange(reference.t[0], reference.t[-1] + 1e-9, _STEP_S)
    rows = reference.at(t)
    leg = reference["leg"][rows]
    feet, com = _seen(recording, t, begin_s, end_s)
    margin = np.full(len(t), np.nan)
    for row in np.flatnonzero((leg >= 0) & np.isin(reference["state"][rows].astype(str), _ON_THE_WAY)):
        margin[row] = SupportTriangle(feet[row], int(leg[row])).margin(com[row])
    return t, leg, margin


def _seen(
    recording: RecordingTables, t: np.ndarray, begin_s: float, end_s: float
) -> tuple[np.ndarray, np.ndarray]:
    """Feet (n, 4, 3) and the centre of mass from above (n, 2) [m]."""
    if "sim/truth" in recording:
        truth = recording.read("sim/truth", ("p_WF", "com_W"), begin_s, end_s)
        rows = truth.at(t)
        return truth["p_WF"][rows], truth["com_W"][rows, :2]
    estimate = recording.read("state/estimate", ("p_WF", "p_WB", "quat_WB", "q"), begin_s, end_s)
    model, rows = SupportMargin(recording.deployment.load_robot()), estimate.at(t)
    com = [model.com(estimate["p_WB"][row], estimate["quat_WB"][row], estimate["q"][row])[:2] for row in rows]
    return estimate["p_WF"][rows], np.array(com)
