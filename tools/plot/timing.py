"""How long the steps of each process took."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from surefoot.bus.topics import PROCESSES, Process, nominal_hz, processes
from surefoot.tools.plot.choice import Choice
from surefoot.tools.reproduce.plots import ASKED, DARK, ESTIMATED, MPC, Axes, Figure, new_figure
from surefoot.tools.tables.recording_tables import RecordingTables
from surefoot.tools.tables.table import NotRecorded, Table

_LOOKS = (
    ("step_p50_ms", "median", MPC),
    ("step_p99_ms", "99 of 100", ASKED),
    ("step_max_ms", "longest", ESTIMATED),
)
_BINS = 48
_LEAST_MS = 1e-3  # a clock's resolution: what is shorter is drawn there
_TICKS = 20  # that a histogram of solves is worth


def timing(recording: RecordingTables, choice: Choice) -> Figure:
    """Step times that the processes tell of themselves; of a run in lockstep, which has none, those of the MPC."""
    told = {name: recording[f"status/{name}"] for name in PROCESSES if f"status/{name}" in recording}
    if told:
        return _of_processes(recording, told)
    return _of_mpc(recording)


def _of_processes(recording: RecordingTables, told: dict[str, Table]) -> Figure:
    figure = new_figure(11.0, 5.2)
    table = processes(recording.deployment.mpc.profile)
    for axes, (name, status) in zip(figure.subplots(2, 4).ravel()[: len(told)], told.items(), strict=True):
        stepped = status["steps"] > 0
        _histograms(axes, [(status[field][stepped], label, color) for field, label, color in _LOOKS])
        _limit(axes, table[name])
        steps, late = (int(status[field].max(initial=0)) for field in ("steps", "overruns"))
        axes.set_title(f"{name}, steps: {steps}" + (f", {late} late" if late else ""))
    _finish(figure, "statuses, two a second")
    return figure


def _of_mpc(recording: RecordingTables) -> Figure:
    """The stages of the MPC's ticks, each a histogram, and their sum."""
    if "mpc/policy" not in recording or recording.counts["mpc/policy"] < _TICKS:
        raise NotRecorded(
            f"{recording.path}: nothing in it says how long anything took: no status of a process, which a run in "
            "lockstep has not, and no policies of the MPC"
        )
    policy = recording.read("mpc/policy", ("stage", "stage_ms"))
    names = [names for names in policy["stage"] if names]
    ms = np.array([each for each in policy["stage_ms"] if len(each)])
    figure = new_figure(8.0, 3.8)
    axes = figure.add_subplot()
    stages = [(ms[:, place], name, f"C{place}") for place, name in enumerate(names[0])]
    _histograms(axes, [*stages, (ms.sum(axis=1), "the whole tick", DARK)])
    _limit(axes, processes(recording.deployment.mpc.profile)["mpc"])
    axes.set_title(f"mpc, {len(ms)} ticks")
    _finish(figure, "ticks")
    return figure


def _histograms(axes: Axes, shown: Sequence[tuple[np.ndarray, str, str]]) -> None:
    """Times [ms] with their label and colour, over the same bins."""
    every = np.maximum(np.concatenate([ms for ms, _, _ in shown]), _LEAST_MS)
    if not len(every):
        return
    bins = np.geomspace(0.8 * every.min(), 1.25 * every.max(), _BINS).tolist()
    for ms, label, color in shown:
        axes.hist(np.maximum(ms, _LEAST_MS), bins, histtype="stepfilled", color=color, alpha=0.5, label=label)


def _limit(axes: Axes, process: Process) -> None:
    """The time after which its output is late."""
    limit_s = process.budget_s or 1.0 / nominal_hz(process)
    axes.axvline(1e3 * limit_s, color="#555555", linestyle=":", label="budget")
    axes.set_xscale("log")


def _finish(figure: Figure, what: str) -> None:
    drawn = [axes for axes in figure.axes if axes.has_data()]
    for axes in figure.axes:
        axes.set_visible(axes in drawn)
        axes.set_xlabel("step time ms")
    drawn[0].set_ylabel(what)
    handles, labels = drawn[0].get_legend_handles_labels()
    figure.legend(handles, labels, loc="outside upper center", ncols=min(len(labels), 4))
