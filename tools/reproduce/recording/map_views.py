"""What the map showed when a foothold was moved by it (Fig. 11)."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from surefoot.bus.message import Message
from surefoot.bus.messages import (
    ElevationGrid,
    FootholdRegions,
    FootholdRequest,
    MotionReference,
    SimTruth,
    Unsafe,
)
from surefoot.config.deployment import Deployment
from surefoot.tools.reproduce.recording.instants import joint_positions
from surefoot.tools.reproduce.recording.recorder import Column

KEPT = 6
"""The views with most of a hole and a foothold that was moved."""


_HOLE = Unsafe.ROUGH | Unsafe.STEEP | Unsafe.EDGE


def hole_cells(unsafe: np.ndarray) -> int:
    """How many cells of a heightmap's flags are unsafe by the shape of the ground that was seen there."""
    return int((((unsafe & _HOLE) != 0) & ((unsafe & Unsafe.UNKNOWN) == 0)).sum())


@dataclass(frozen=True)
class _View:
    score: int
    arrays: dict[str, np.ndarray]


class MapViews:
    """The map around the robot and the foothold heightmap of the leg that moves next."""

    columns = (
        Column("t_s", "simulated time [s]"),
        Column("leg", "leg that moves next: 0 FL, 1 FR, 2 RL, 3 RR"),
        Column("target_x_m", "desired touch-down, x in the world [m]"),
        Column("target_y_m", "desired touch-down, y in the world [m]"),
        Column("foothold_x_m", "foothold chosen by the map, x in the world [m]"),
        Column("foothold_y_m", "foothold chosen by the map, y in the world [m]"),
        Column("unsafe_cells", "of the 225 cells of the foothold heightmap"),
    )

    def __init__(self, deployment: Deployment):
        self._truth: SimTruth | None = None
        self._grid: ElevationGrid | None = None
        self._reference: MotionReference | None = None
        self._requests: dict[int, FootholdRequest] = {}
        self._views: list[_View] = []
        self._rows: list[list[float | str]] = []

    def __call__(self, key: str, message: Message) -> None:
        if isinstance(message, SimTruth):
            self._truth = message
        elif isinstance(message, ElevationGrid):
            self._grid = message
        elif isinstance(message, MotionReference):
            self._reference = message
        elif isinstance(message, FootholdRequest):
            self._requests = {message.id: message}
        elif isinstance(message, FootholdRegions):
            self._on_regions(message)

    def _on_regions(self, regions: FootholdRegions) -> None:
        request, reference = self._requests.get(regions.id), self._reference
        truth, grid = self._truth, self._grid
        if request is None or reference is None or truth is None or grid is None:
            return
        leg = reference.leg
        if leg < 0 or not regions.region_active[leg]:
            return
        unsafe = int((regions.heightmap_unsafe[leg] != 0).sum())
        target, foothold = request.target_WF[leg], regions.foothold_WF[leg]
        self._rows.append([truth.t, leg, *target[:2].tolist(), *foothold[:2].tolist(), unsafe])
        moved_m = float(np.hypot(*(foothold - target)[:2]))
        view = {
            "t": np.array(truth.t),
            "leg": np.array(leg),
            "target_W": target,
            "foothold_W": foothold,
            "region_a": regions.region_a[leg],
            "region_b": regions.region_b[leg],
            "cell_m": np.array(regions.cell_m),
            "heightmap_p_W": regions.heightmap_p_W[leg],
            "heightmap_m": regions.heightmap_m[leg],
            "heightmap_unsafe": regions.heightmap_unsafe[leg],
            "grid_cell_m": np.array(grid.cell_m),
            "grid_p_W": grid.p_W,
            "grid_m": grid.height_m,
            "p_WF": truth.p_WF,
            "p_WB": truth.p_WB,
            "qpos": joint_positions(truth),
        }
        moved = moved_m > 0.5 * regions.cell_m
        self._views.append(_View(hole_cells(regions.heightmap_unsafe[leg]) if moved else 0, view))
        self._views = sorted(self._views, key=lambda each: -each.score)[:KEPT]

    def arrays(self) -> dict[str, np.ndarray]:
        """Each entry of the views stacked along the first axis, best view first; no entry without a view."""
        if not self._views:
            return {}
        return {key: np.stack([view.arrays[key] for view in self._views]) for key in self._views[0].arrays}

    def rows(self) -> list[list[float | str]]:
        return self._rows
