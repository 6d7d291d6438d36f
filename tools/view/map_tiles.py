"""The elevation map as tiles: heights, and over them what the ground is known to bear."""

from __future__ import annotations

import numpy as np

from surefoot.bus.messages import ElevationGrid
from surefoot.tools.view.drawing import Drawing, Shapes, level
from surefoot.tools.view.palette import VERDICT_RGB, Verdict, height_rgb, held_rgb

_SHARE = 0.92  # of a cell: the gaps let the grid be seen
_LOAD_ABOVE_M = 0.004


def draw_map(grid: ElevationGrid) -> Drawing:
    """Known cells by their height; on top those that were tested: green has held, red gave way."""
    x = grid.p_W[0] + grid.cell_m * np.arange(grid.height_m.shape[0])
    y = grid.p_W[1] + grid.cell_m * np.arange(grid.height_m.shape[1])
    centres = np.stack([*np.meshgrid(x, y, indexing="ij"), grid.height_m], axis=-1)
    known = np.isfinite(grid.height_m)
    heights = _tiles(centres[known], grid.cell_m, height_rgb(grid.height_m[known]))
    tested = known & ((grid.held_n > 0.0) | (grid.collapsed_n > 0.0))
    rgb = held_rgb(grid.held_n[tested])
    rgb[grid.collapsed_n[tested] > 0.0] = VERDICT_RGB[Verdict.COLLAPSED]
    loads = _tiles(centres[tested] + [0.0, 0.0, _LOAD_ABOVE_M], grid.cell_m, rgb)
    return {"map/heights": heights, "loads/cells": loads}


def _tiles(p_W: np.ndarray, cell_m: float, rgb: np.ndarray) -> Shapes:
    return level("square", p_W, (_SHARE * cell_m, _SHARE * cell_m, 1.0), rgb)
