"""Figs. 9 and 10 of any probe: forces on the foot that presses, and the centre of mass over the other three."""

from __future__ import annotations

import numpy as np

from surefoot.config.robot import LEGS
from surefoot.tools.plot.choice import Choice
from surefoot.tools.plot.force_displacement import draw_curves
from surefoot.tools.plot.probes import Press, Probe
from surefoot.tools.reproduce.force_tracking import tracking
from surefoot.tools.reproduce.plots import COM, Axes, Figure, new_figure
from surefoot.tools.reproduce.polygon_and_force import stability_row
from surefoot.tools.reproduce.recording.forces import ForceSeries
from surefoot.tools.tables.recording_tables import RecordingTables
from surefoot.tools.tables.table import NotRecorded

_HEARD = ("sim/truth", "state/estimate", "joint/command", "mpc/policy", "fsm/reference")
_BEFORE_S = 0.1  # so that every topic has had a message when the probe begins
_COLUMNS = 4
_MARGIN_MM = 1e3


def forces(recording: RecordingTables, choice: Choice) -> Figure:
    """Fig. 10: the chosen probe, or the first of each leg."""
    probes = pressed(choice.probes(recording))
    if not choice.number:
        first = {probe.leg: probe for probe in reversed(probes)}
        probes = sorted(first.values(), key=lambda probe: probe.begin_t)[:_COLUMNS]
    columns = []
    for probe in probes:
        press = shown_press(probe)
        series = force_series(recording, probe, press)
        columns.append((title(probe, press), series, pressing_rows(recording, series, press)))
    return tracking(columns)


def probing(recording: RecordingTables, choice: Choice) -> Figure:
    """Fig. 9: one probe whole: forces, support polygon, margin and displacement."""
    probe = pressed(choice.probes(recording))[0]
    press = shown_press(probe)
    series = force_series(recording, probe, press)
    rows = pressing_rows(recording, series, press)
    figure = new_figure(11.0, 5.8)
    grid = figure.add_gridspec(2, 4, width_ratios=[1.2, 1.0, 1.0, 1.25], height_ratios=[1.0, 0.85])
    panels = [figure.add_subplot(grid[0, column]) for column in range(4)]
    stability_row(panels, series, rows, title(probe, press), ("true", "asked", "mpc", "estimated"))
    _margin_panel(figure.add_subplot(grid[1, :2]), recording, series, rows)
    draw_curves(figure.add_subplot(grid[1, 2:]), recording, [probe])
    handles, labels = panels[0].get_legend_handles_labels()
    figure.legend(handles, labels, loc="outside upper center", ncols=4)
    return figure


def force_series(recording: RecordingTables, probe: Probe, press: Press) -> dict[str, np.ndarray]:
    """What `ForceSeries` keeps of a probe up to the end of one of its presses."""
    series = ForceSeries(recording.deployment)
    for key, message in recording.messages(_HEARD, probe.begin_t - _BEFORE_S, press.end_t):
        series(key, message)
    return series.arrays()


def pressing_rows(recording: RecordingTables, series: dict[str, np.ndarray], press: Press) -> np.ndarray:
    """Rows of a series in which the press lasts.

    Raises:
        NotRecorded: there is none.
    """
    inside = (series["t"] >= press.begin_t - 1e-9) & (series["t"] <= press.end_t)
    rows = np.flatnonzero(series["pressing"] & (series["around"] == press.around) & inside)
    if not len(rows):
        raise NotRecorded(
            f"{recording.path}: no fsm/reference and state/estimate of the probe at {press.begin_t:.1f} s in it"
        )
    return rows


def pressed(probes: list[Probe]) -> list[Probe]:
    """Those in which a force was asked.

    Raises:
        NotRecorded: it was in none.
    """
    found = [probe for probe in probes if probe.presses]
    if not found:
        began = ", ".join(f"{LEGS[probe.leg]} at {probe.begin_t:.1f} s: {probe.verdict}" for probe in probes)
        raise NotRecorded(f"no foot has pressed in what was chosen ({began})")
    return found


def shown_press(probe: Probe) -> Press:
    """The one of the foothold itself; where it is not recorded, the first around it."""
    return next((press for press in probe.presses if not press.around), probe.presses[0])


def title(probe: Probe, press: Press) -> str:
    """Which probe it is, in a few words."""
    around = f", around point {press.around}" if press.around else ""
    return f"{LEGS[probe.leg]} at {press.begin_t:.1f} s{around}"


def _margin_panel(axes: Axes, recording: RecordingTables, series: dict[str, np.ndarray], rows: np.ndarray) -> None:
    """Distance of the centre of mass from the nearest edge, from lift-off to the end of the press."""
    t = series["t"][: rows[-1] + 1]
    begin = series["t"][rows[0]]
    axes.plot(t - begin, _MARGIN_MM * series["margin_m"][: rows[-1] + 1], color=COM)
    axes.axvspan(0.0, t[-1] - begin, color="#e8850c", alpha=0.08, linewidth=0.0, label="the foot presses")
    asked = _MARGIN_MM * recording.deployment.fsm.margin_m
    axes.axhline(asked, color="#888888", linestyle=":", label=f"margin of eq. (5), {asked:.0f} mm")
    axes.axhline(0.0, color="#888888", linewidth=0.8)
    axes.set(title="Centre of mass inside the other three feet", xlabel="time s", ylabel="mm")
    axes.legend(loc="best")
