"""Fig. 11: planks with boards gone: the map keeps the foot out of the hole, probing finds what it cannot see."""

from __future__ import annotations

from itertools import combinations
from pathlib import Path
from typing import Any

import numpy as np
from matplotlib.axes import Axes
from matplotlib.patches import Rectangle

from surefoot.config.robot import LEGS
from surefoot.tools.document import Part, Pictures, Words
from surefoot.tools.evaluation.one_run import LIMIT_S
from surefoot.tools.reproduce.experiment import Evidence, Experiment, Plan, crossing_table, per_foothold
from surefoot.tools.reproduce.plots import ASKED, DARK, MPC, new_figure, save, styled
from surefoot.tools.reproduce.recorded_run import RecordedRun
from surefoot.tools.reproduce.recording.map_views import hole_cells
from surefoot.tools.reproduce.run_spec import RunSpec
from surefoot.tools.reproduce.snapshots import Shot, View

SEEDS = (0, 1, 2)
_PARALLEL = 1e-9
MapView = dict[str, np.ndarray]


def specs(plan: Plan) -> list[RunSpec]:
    """The same boards are missing with the map and without."""
    limit_s = plan.settings.quick_limit_s if plan.quick else LIMIT_S
    found = []
    for label, vision, recorders in (
        ("vision", "true", ("instants", "map_views")),
        ("blind", "false", ("instants",)),
    ):
        for seed in plan.seeds_or(SEEDS):
            overrides = (f"run.vision={vision}",)
            found.append(RunSpec("planks_missing", "full", seed, limit_s, recorders, overrides, label))
    return found


def best_view(runs: list[RecordedRun]) -> tuple[RecordedRun, MapView] | None:
    """The view, of all runs, in which the foothold was moved and most of a hole is seen; None without one."""
    found: list[tuple[int, RecordedRun, MapView]] = []
    for run in runs:
        views = run.arrays("map_views")
        if views:
            hole = hole_cells(views["heightmap_unsafe"][0])
            moved = np.hypot(*(views["foothold_W"][0] - views["target_W"][0])[:2]) > 0.5 * views["cell_m"][0]
            found.append((hole if moved else 0, run, {key: value[0] for key, value in views.items()}))
    best = max(found, key=lambda each: each[0], default=None)
    return best[1:] if best is not None and best[0] else None


def region_corners(a: np.ndarray, b: np.ndarray, z: float) -> np.ndarray:
    """(n, 2) corners of the convex region A p + b >= 0 of eq. (4) at height z, anticlockwise [m].

    Args:
        a: (m, 3) rows A.
        b: (m,) [m].
        z: height at which the region is cut [m].
    """
    offsets = b + a[:, 2] * z
    points = []
    for first, second in combinations(range(len(b)), 2):
        pair = a[[first, second], :2]
        if abs(np.linalg.det(pair)) > _PARALLEL:
            point = np.linalg.solve(pair, -offsets[[first, second]])
            if (a[:, :2] @ point + offsets >= -1e-6).all():
                points.append(point)
    corners = np.array(points).reshape(-1, 2)
    around = corners - corners.mean(axis=0) if len(corners) else corners
    return corners[np.argsort(np.arctan2(around[:, 1], around[:, 0]))]


def report(evidence: Evidence) -> list[Part]:
    """The map with the hole, the foothold heightmap, the snapshot, and vision against blind."""
    vision, blind = evidence.arms.get("vision", []), evidence.arms.get("blind", [])
    quick = evidence.plan.quick
    parts: list[Part] = []
    chosen = best_view(vision)
    if chosen is not None:
        run, view = chosen
        parts += [draw_maps(run, view, evidence.folder), _snapshot(evidence, run, view)]
    elif vision:
        parts.append(Words("In these runs the map moved no foothold: there is nothing to show of it."))
    if vision:
        collapses = sum(run.result["collapses_detected"] for run in vision)
        parts.append(
            Words(
                f"Candidates tried for each foothold: {per_foothold(vision)} with the map, {per_foothold(blind)} "
                f"blind. Collapses that probing found with the map: {collapses}; where a board is left, the map "
                "sees flat ground."
            )
        )
        parts.append(crossing_table(vision, quick, "With depth camera, map and foothold adaptation."))
    if blind:
        parts.append(crossing_table(blind, quick, "The same boards missing, blind."))
    return parts


def draw_maps(run: RecordedRun, view: MapView, folder: Path) -> Pictures:
    """The map around the robot, and the foothold heightmap beside it."""
    with styled():
        figure = new_figure(10.0, 5.0)
        left, right = figure.subplots(1, 2, width_ratios=[1.15, 1.0])
        for axes in (left, right):
            axes.grid(False)
            axes.set_aspect("equal")
            axes.set_xlabel("to the right m")
            axes.set_ylabel("ahead m")
        known = view["grid_m"][np.isfinite(view["grid_m"])]
        span = (float(known.min()), float(known.max())) if len(known) else (-0.1, 0.0)
        image = _heights(left, view["grid_m"], view["grid_p_W"], float(view["grid_cell_m"]), span)
        figure.colorbar(image, ax=left, label="height m", shrink=0.8)
        left.plot(-view["p_WF"][:, 1], view["p_WF"][:, 0], "o", color="#222222", markersize=6, label="feet")
        side = (len(view["heightmap_m"]) - 0.5) * float(view["cell_m"])
        near = view["heightmap_p_W"] - 0.5 * float(view["cell_m"])
        left.add_patch(_square(near, side))
        _foothold(left, view)
        left.set_title(f"Map around the robot, {float(view['t']):.1f} s")
        left.legend(loc="upper center", bbox_to_anchor=(0.5, -0.13), ncols=3, fontsize=7.5)
        _heightmap(right, view, span)
        path = save(figure, folder / "map.svg")
    caption = (
        f"Seed {run.spec.seed}: the elevation map, and the foothold heightmap of {LEGS[int(view['leg'])]} "
        "(orange square). White dots are safe cells, black ones unsafe, cells left white unknown; the outline is "
        "the region of eq. (4). The foothold (blue square) is moved from the target (ring) to safe ground."
    )
    return Pictures(caption, [path], ["Elevation map with the hole and foothold heightmap"])


def _heights(axes: Axes, height_m: np.ndarray, p_W: np.ndarray, cell_m: float, span: tuple[float, float]):
    """A map from above, x up and y to the left, as the robot walks; unknown cells are left white."""
    x0, y0 = p_W - 0.5 * cell_m
    x1, y1 = p_W + (np.array(height_m.shape) - 0.5) * cell_m
    return axes.imshow(
        height_m[:, ::-1],
        origin="lower",
        extent=(-y1, -y0, x0, x1),
        cmap="copper",
        vmin=span[0],
        vmax=span[1],
        interpolation="nearest",
    )


def _square(near_W: np.ndarray, side_m: float):
    return Rectangle((-near_W[1] - side_m, near_W[0]), side_m, side_m, fill=False, edgecolor=ASKED, linewidth=2.0)


def _foothold(axes: Axes, view: MapView) -> None:
    target, foothold = view["target_W"], view["foothold_W"]
    ring: Any = {"markerfacecolor": "none", "markeredgecolor": ASKED, "markersize": 10, "markeredgewidth": 2.0}
    axes.plot(-target[1], target[0], "o", label="target", linestyle="none", **ring)
    axes.plot(-foothold[1], foothold[0], "s", color=MPC, markersize=8, label="foothold", linestyle="none")


def _heightmap(axes: Axes, view: MapView, span: tuple[float, float]) -> None:
    cell, first = float(view["cell_m"]), view["heightmap_p_W"]
    _heights(axes, view["heightmap_m"], first, cell, span)
    x, y = np.meshgrid(
        *(first[axis] + cell * np.arange(view["heightmap_m"].shape[axis]) for axis in (0, 1)), indexing="ij"
    )
    safe = view["heightmap_unsafe"] == 0
    for cells, face, edge, label in (
        (safe, "#ffffff", "#555555", "safe"),
        (~safe, "#111111", "#ffffff", "unsafe"),
    ):
        axes.plot(
            -y[cells],
            x[cells],
            "o",
            markersize=4.5,
            markerfacecolor=face,
            markeredgecolor=edge,
            markeredgewidth=0.5,
            linestyle="none",
            label=label,
        )
    corners = region_corners(view["region_a"], view["region_b"], float(view["foothold_W"][2]))
    if len(corners) > 2:
        axes.fill(-corners[:, 1], corners[:, 0], fill=False, edgecolor=DARK, linewidth=2.0)
    _foothold(axes, view)
    half = 0.5 * cell
    axes.set_xlim(-y.max() - half, -y.min() + half)
    axes.set_ylim(x.min() - half, x.max() + half)
    axes.set_title("Foothold heightmap")
    axes.legend(loc="upper center", bbox_to_anchor=(0.5, -0.13), ncols=4, fontsize=7.5)


def _snapshot(evidence: Evidence, run: RecordedRun, view: MapView) -> Pictures:
    x, y, _ = view["target_W"]
    side = -1.0 if int(view["leg"]) in (0, 2) else 1.0
    shot = Shot(
        view["qpos"], View((float(x) - 0.1, float(y), 0.1), side * 128.0, -28.0, 1.3), evidence.folder / "hole.jpg"
    )
    label = f"{LEGS[int(view['leg'])]} is to be moved, {float(view['t']):.1f} s"
    return evidence.snapshots(run, [(shot, label)], f"The same instant (seed {run.spec.seed}).")


EXPERIMENT = Experiment(
    "fig11_missing_planks",
    "Fig. 11 – Planks missing, with the map",
    "Some planks are removed: the map marks the hole as unsafe and the foothold is chosen outside it. Probing is "
    "still necessary, since what looks safe may collapse.",
    specs,
    report,
)
