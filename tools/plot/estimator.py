"""What was estimated beside what was true."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from surefoot.config.robot import LEGS
from surefoot.tools.plot.choice import Choice
from surefoot.tools.reproduce.plots import ESTIMATED, TRUE, Axes, Figure, new_figure, rmse
from surefoot.tools.tables.recording_tables import RecordingTables
from surefoot.tools.tables.table import NotRecorded, Table

_AXES = ("x", "y", "z")
_MOST = 4_000  # points of a line that a picture can show
_HEADROOM = 0.28  # of a panel, for its legend
_FIELDS = ("p_WB", "quat_WB", "v_WB_W", "force_W")


def estimator(recording: RecordingTables, choice: Choice) -> Figure:
    """Errors of position, orientation and velocity over time; with a leg, its force estimated and true as well."""
    estimate, truth = _pair(recording, choice)
    errors = {
        "position of the trunk: estimate less truth, mm": 1e3 * (estimate["p_WB"] - truth["p_WB"]),
        "orientation, about the world's axes, degrees": np.rad2deg(
            rotation_error(estimate["quat_WB"], truth["quat_WB"])
        ),
        "velocity, mm/s": 1e3 * (estimate["v_WB_W"] - truth["v_WB_W"]),
    }
    one_leg = choice.leg >= 0
    figure = new_figure(10.0, 6.2 + 1.8 * one_leg)
    panels = figure.subplots(3 + one_leg, 1, sharex=True)
    for axes, (title, error) in zip(panels, errors.items(), strict=False):
        _error_panel(axes, truth["t"], error, title)
    if one_leg:
        true_n, told_n = truth["force_W"][:, choice.leg, 2], estimate["force_W"][:, choice.leg, 2]
        panels[-1].plot(truth["t"], true_n, color=TRUE, linewidth=0.9, label="true (simulator)")
        panels[-1].plot(
            truth["t"], told_n, color=ESTIMATED, linestyle="--", linewidth=1.0, label="estimated, eq. (7)"
        )
        panels[-1].set_title(
            f"vertical force on {LEGS[choice.leg]}, N: RMS difference {rmse(told_n, true_n):.1f} N"
        )
        panels[-1].margins(y=_HEADROOM)
        panels[-1].legend(loc="upper left", ncols=2)
    panels[-1].set_xlabel("time s")
    return figure


def rotation_error(estimate: np.ndarray, truth: np.ndarray) -> np.ndarray:
    """(n, 3) small rotations in the world from the true to the estimated attitude [rad], quaternions (n, 4)."""
    w, v = truth[:, :1], truth[:, 1:]
    w_e, v_e = estimate[:, :1], estimate[:, 1:]
    real = w_e * w + np.sum(v_e * v, axis=1, keepdims=True)
    return 2.0 * np.sign(real) * (w * v_e - w_e * v + np.cross(v, v_e))


def _pair(recording: RecordingTables, choice: Choice) -> tuple[dict[str, np.ndarray], dict[str, np.ndarray]]:
    """Estimate and truth at the times of the truth."""
    if "sim/truth" not in recording:
        raise NotRecorded(
            f"{recording.path}: no sim/truth in it: it is of a robot, or a clip; there is nothing to compare with"
        )
    begin, end = recording.span_s
    if choice.number:
        (probe,) = choice.probes(recording)
        begin, end = probe.begin_t, probe.end_t
    estimate = recording.read("state/estimate", _FIELDS, begin, end)
    truth = recording.read("sim/truth", _FIELDS, begin, end)
    after = np.flatnonzero(truth.t >= estimate.t[0])
    rows = after[:: len(after) // _MOST + 1]
    return _rows(estimate, estimate.at(truth.t[rows])), _rows(truth, rows)


def _rows(table: Table, rows: np.ndarray) -> dict[str, np.ndarray]:
    return {field: table[field][rows] for field in ("t", *_FIELDS)}


def _error_panel(axes: Axes, t: np.ndarray, error: np.ndarray, title: str) -> None:
    colors: Sequence[str] = ("#1f5fbf", "#e8850c", "#1c7a3c")
    for column, (name, color) in enumerate(zip(_AXES, colors, strict=True)):
        worst = float(np.abs(error[:, column]).max())
        axes.plot(t, error[:, column], color=color, linewidth=1.0, label=f"{name}, at most {worst:.3g}")
    axes.axhline(0.0, color="#888888", linewidth=0.8)
    axes.set_title(title)
    axes.margins(y=_HEADROOM)
    axes.legend(loc="upper left", ncols=3)
