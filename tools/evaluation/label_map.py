"""The press test's label over a terrain: where a foot that presses with a force goes through, as a picture."""

from __future__ import annotations

import csv
from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from surefoot.config.deployment import Deployment
from surefoot.config.typed_toml import ConfigError
from surefoot.hw.mujoco.press_test import COLLAPSE_M, PressTest
from surefoot.hw.mujoco.scene import build_scene

FORCE_MOST_N = 2000.0
STEP_LEAST_M, STEP_MOST_M = 0.002, 0.2

_BEFORE_M = 0.10  # of the run-up and the run-out that is drawn too
_HALF_WIDTH_M = 0.45  # a robot's stance and what it may stray
_TOLD_EVERY = 10  # rows
_DEEPEST_CM = 10.0  # what sinks further has the same colour


@dataclass(frozen=True)
class LabelMap:
    """Displacement of a pressed foot on a grid.

    Attributes:
        x_m: (n,) along the walk, in the world.
        y_m: (m,) to the left.
        displacement_m: (n, m); NaN where there is no ground.
        force_n: normal force.
    """

    x_m: np.ndarray
    y_m: np.ndarray
    displacement_m: np.ndarray
    force_n: float

    @property
    def collapsible(self) -> np.ndarray:
        """(n, m) where the ground gives way at this force."""
        return self.displacement_m > COLLAPSE_M


def press_terrain(
    deployment: Deployment, force_n: float, step_m: float = 0.01, say: Callable[[str], None] = print
) -> LabelMap:
    """Press the whole terrain of a deployment, from a little before it to a little behind.

    Args:
        deployment: its terrain, and the seed of what that leaves to chance.
        force_n: normal force of every press.
        step_m: from point to point.
        say: told how far it is.

    Raises:
        ConfigError: a force or a step that cannot be pressed.
    """
    if not 1.0 < force_n <= FORCE_MOST_N:
        raise ConfigError(
            f"--force {force_n:g}: above 1 N, with which the foot rests, and at most {FORCE_MOST_N:g} N"
        )
    if not STEP_LEAST_M <= step_m <= STEP_MOST_M:
        raise ConfigError(f"--step {step_m:g}: allowed {STEP_LEAST_M:g} to {STEP_MOST_M:g} m")
    _, field = build_scene(deployment, None, deployment.hw.friction_max)
    test = PressTest(deployment)
    xs = np.arange(field.start_x - _BEFORE_M, field.end_x + _BEFORE_M + 1e-9, step_m)
    ys = np.arange(-_HALF_WIDTH_M, _HALF_WIDTH_M + 1e-9, step_m)
    displacement = np.empty((len(xs), len(ys)))
    for row, x in enumerate(xs.tolist()):
        displacement[row] = [_press(test, x, y, force_n) for y in ys.tolist()]
        if (row + 1) % _TOLD_EVERY == 0 or row + 1 == len(xs):
            say(f"{row + 1} of {len(xs)} rows pressed")
    return LabelMap(xs, ys, displacement, force_n)


def _press(test: PressTest, x: float, y: float, force_n: float) -> float:
    try:
        return test.press(x, y, force_n).displacement_m
    except ValueError:  # no ground
        return np.nan


def draw(label: LabelMap, title: str, out: Path) -> None:
    """Draw a map as a picture at `out` (.png), and write its figures beside it (.csv)."""
    Figure, FigureCanvasAgg = _drawing()
    x, y, moved = label.x_m, label.y_m, 1e2 * label.displacement_m
    figure = Figure(figsize=(9.0, 5.5), layout="constrained")
    FigureCanvasAgg(figure)
    axes = figure.add_subplot()
    half_x, half_y = 0.5 * (x[1] - x[0]), 0.5 * (y[1] - y[0])
    image = axes.imshow(
        moved.T,
        origin="lower",
        extent=(x[0] - half_x, x[-1] + half_x, y[0] - half_y, y[-1] + half_y),
        cmap="viridis_r",
        vmin=0.0,
        vmax=_DEEPEST_CM,
    )
    limit = 1e2 * COLLAPSE_M
    known = np.nan_to_num(moved, nan=_DEEPEST_CM)
    if known.min() < limit < known.max():
        axes.contour(x, y, known.T, levels=[limit], colors="red", linewidths=1.0)
    bar = figure.colorbar(image, ax=axes, extend="max", shrink=0.8, label="displacement of the foot, cm")
    bar.ax.axhline(limit, color="red")
    axes.set(xlabel="x, along the walk, m", ylabel="y, to the left, m", title=title, aspect="equal")
    out.parent.mkdir(parents=True, exist_ok=True)
    figure.savefig(out, dpi=130)
    with out.with_suffix(".csv").open("w", newline="") as file:
        rows = csv.writer(file)
        rows.writerow(["x_m", "y_m", "displacement_m"])
        for i, j in np.ndindex(label.displacement_m.shape):
            rows.writerow([f"{x[i]:.4f}", f"{y[j]:.4f}", f"{label.displacement_m[i, j]:.5f}"])


def check_drawing(out: Path) -> None:
    """Say before the work, not after it, that the picture cannot be drawn.

    Raises:
        ConfigError: matplotlib is not installed, or the file is not to be a PNG.
    """
    if out.suffix != ".png":
        raise ConfigError(f"--out {out}: a picture is a .png; its figures go beside it as .csv")
    _drawing()


def _drawing():
    """The parts of matplotlib that need no display."""
    try:
        from matplotlib.backends.backend_agg import FigureCanvasAgg
        from matplotlib.figure import Figure
    except ImportError:
        raise ConfigError("drawing needs matplotlib: pip install 'surefoot[report]'") from None
    return Figure, FigureCanvasAgg
