"""The look of all plots, and the pieces that more than one figure draws.

Colours are the paper's: orange what the envelope asks, blue the MPC, red the estimate from joint torques.
"""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np

from surefoot.components.fsm.support_triangle import SupportTriangle
from surefoot.config.typed_toml import ConfigError

try:
    import matplotlib
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure
    from matplotlib.ticker import MultipleLocator
except ModuleNotFoundError as error:
    raise ConfigError(f"the plots need matplotlib ({error}): pip install 'surefoot[report]'") from error

ASKED, MPC, ESTIMATED, TRUE = "#e8850c", "#1f5fbf", "#c81e1e", "#555555"
DARK, COM = "#1c3d6e", "#8e1b1b"

_STYLE: Any = {
    "svg.hashsalt": "surefoot",  # the same data give the same file
    "font.family": "DejaVu Sans",
    "font.size": 9.0,
    "axes.grid": True,
    "grid.color": "#e3e3e3",
    "grid.linewidth": 0.6,
    "axes.spines.top": False,
    "axes.spines.right": False,
    "axes.edgecolor": "#888888",
    "axes.titlesize": 9.5,
    "axes.titleweight": "bold",
    "legend.frameon": False,
    "lines.linewidth": 1.5,
}


def new_figure(width_in: float, height_in: float) -> Figure:
    """An empty figure in the common style; draw in it inside `styled()`."""
    return Figure(figsize=(width_in, height_in), layout="constrained")


def styled():
    """The style, as a context."""
    return matplotlib.rc_context(_STYLE)


def save(figure: Figure, path: Path) -> Path:
    """Write an SVG without a date, so that the same data give the same bytes."""
    figure.savefig(path, metadata={"Date": None})
    return path


def force_panel(axes: Axes, t: np.ndarray, values: dict[str, np.ndarray], title: str) -> None:
    """One force component over time: every given one of asked, mpc, estimated, true (n,) [N] that was told."""
    looks = {
        "true": ("true (simulator)", TRUE, "-", 0.9),
        "asked": ("envelope, asked", ASKED, "-", 2.4),
        "mpc": ("MPC", MPC, "-", 1.5),
        "estimated": ("estimated, eq. (7)", ESTIMATED, "--", 1.2),
    }
    for name, (label, color, line, width) in looks.items():
        if name in values and np.isfinite(values[name]).any():
            axes.plot(t, values[name], color=color, linestyle=line, linewidth=width, label=label)
    axes.set_title(title)
    axes.set_xlabel("time s")
    axes.set_ylabel("N")


def polygon_panel(axes: Axes, p_WF: np.ndarray, leg: int, com_W: np.ndarray, margin_m: np.ndarray) -> None:
    """The triangle of the other three feet with the CoM's projections, from above; the walk goes to the right.

    Args:
        axes: to draw in.
        p_WF: (4, 2) feet [m].
        leg: the one that probes.
        com_W: (n, 2) projections of the centre of mass [m].
        margin_m: (n,) their distance from the nearest edge, positive inside [m].
    """
    corners = SupportTriangle(p_WF, leg).corners
    axes.fill(corners[:, 0], corners[:, 1], facecolor="#dfe8f5", edgecolor=DARK, linewidth=1.8)
    axes.plot(p_WF[leg, 0], p_WF[leg, 1], "o", color=ASKED, markersize=8)
    axes.annotate(
        "probing foot",
        (p_WF[leg, 0], p_WF[leg, 1]),
        xytext=(-7, -3) if leg < 2 else (7, -3),
        textcoords="offset points",
        ha="right" if leg < 2 else "left",
        fontsize=7.5,
    )
    axes.plot(com_W[:, 0], com_W[:, 1], ".", color=COM, markersize=3)
    least_mm = 1e3 * float(margin_m.min())
    axes.set_title(f"CoM: {abs(least_mm):.0f} mm {'inside' if least_mm >= 0.0 else 'outside'} at the least")
    axes.set_aspect("equal")
    axes.margins(0.14)
    axes.xaxis.set_major_locator(MultipleLocator(0.2))
    axes.yaxis.set_major_locator(MultipleLocator(0.1))
    axes.set_xlabel("ahead m")
    axes.set_ylabel("to the left m")


def normal_component(force_W: np.ndarray, normal_W: np.ndarray) -> np.ndarray:
    """(n,) of forces (n, 3) along normals (n, 3) [N]."""
    return np.einsum("ni,ni->n", force_W, normal_W)


def rmse(first: np.ndarray, second: np.ndarray) -> float:
    """Root of the mean square difference; NaN without samples."""
    difference = first - second
    difference = difference[np.isfinite(difference)]
    return float(np.sqrt(np.mean(difference**2))) if len(difference) else float("nan")
