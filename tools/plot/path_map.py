"""The map of a run from above: the terrain, the way of the trunk, every foothold and what came of it."""

from __future__ import annotations

from typing import Any

import numpy as np

from surefoot.config.robot import LEGS
from surefoot.tools.plot.choice import Choice
from surefoot.tools.plot.probes import VERDICTS, Probe
from surefoot.tools.plot.terrain_outline import Outline, outlines
from surefoot.tools.plot.verdict_looks import COLORS, MARKS
from surefoot.tools.reproduce.plots import DARK, Axes, Figure, new_figure
from surefoot.tools.tables.recording_tables import RecordingTables

_MARGIN_M = 0.12
_EVERY = 10  # estimate on the trunk's way: its sway is slower
_WIDTH_IN = 10.0
_LEGEND_IN, _MOST_IN = 0.9, 7.5


def path(recording: RecordingTables, choice: Choice) -> Figure:
    """As the robot estimated it; the terrain as it was built."""
    probes = choice.probes(recording) if "fsm/event" in recording else []
    estimate = recording.read("state/estimate", ("p_WB", "p_WF"))
    way, start = estimate["p_WB"][:, :2], estimate["p_WF"][0, :, :2]
    points = np.concatenate([way, start, [probe.p_WF[:2] for probe in probes] or np.zeros((0, 2))])
    points = points[np.isfinite(points).all(axis=1)]
    low, high = points.min(axis=0) - _MARGIN_M, points.max(axis=0) + _MARGIN_M
    height = _WIDTH_IN * (high[1] - low[1]) / (high[0] - low[0])
    figure = new_figure(_WIDTH_IN, min(height + _LEGEND_IN, _MOST_IN))
    axes = figure.add_subplot()
    for outline in outlines(recording.deployment):
        _draw_outline(axes, outline)
    axes.plot(way[::_EVERY, 0], way[::_EVERY, 1], color=DARK, linewidth=0.8, label="trunk")
    axes.plot(
        start[:, 0], start[:, 1], "o", markerfacecolor="white", markeredgecolor=DARK, label="feet at the start"
    )
    for verdict in VERDICTS:
        _draw_verdict(axes, [probe for probe in probes if probe.verdict == verdict], verdict)
    axes.set(
        xlim=(low[0], high[0]), ylim=(low[1], high[1]), xlabel="ahead m", ylabel="to the left m", aspect="equal"
    )
    axes.set_axisbelow(True)
    handles, labels = axes.get_legend_handles_labels()
    figure.legend(handles, labels, loc="outside upper center", ncols=len(labels))
    return figure


def _draw_outline(axes: Axes, outline: Outline) -> None:
    axes.fill(
        outline.corners[:, 0],
        outline.corners[:, 1],
        facecolor=outline.rgb,
        edgecolor="#ffffff",
        linewidth=0.5,
        alpha=0.45,
        zorder=0.5,
    )


def _draw_verdict(axes: Axes, probes: list[Probe], verdict: str) -> None:
    probes = [probe for probe in probes if np.isfinite(probe.p_WF).all()]  # one that begins has no place yet
    if not probes:
        return
    points = np.array([probe.p_WF[:2] for probe in probes])
    look: Any = {"color": COLORS[verdict], "markeredgecolor": "white", "markersize": 8, "zorder": 3}
    axes.plot(points[:, 0], points[:, 1], MARKS[verdict], linestyle="", label=f"{verdict} ({len(points)})", **look)
    for probe in probes:
        candidate = f"{LEGS[probe.leg]}{probe.candidate or ''}"
        axes.annotate(
            candidate,
            (probe.p_WF[0], probe.p_WF[1]),
            xytext=(6, 3),
            textcoords="offset points",
            fontsize=7.0,
            zorder=4,
        )
