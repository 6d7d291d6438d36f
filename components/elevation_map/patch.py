"""A rectangle cut out of the map: what the foothold adaptation works on."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np


@dataclass(frozen=True)
class Patch:
    """Cells of the map, x by y; axis 0 runs along the world's x. What is outside the map is unknown.

    Attributes:
        cell_m: side of a cell [m].
        p_W: (2,) x, y of the centre of cell [0, 0] [m].
        height_m: (n, m) height of the ground [m]; NaN unknown.
        std_m: (n, m) its standard deviation [m]; NaN unknown.
        age_s: (n, m) time since the cell was seen [s]; NaN never.
        held_n: (n, m) largest load that has held there and has not given way since [N]; 0 untested.
        collapsed_n: (n, m) load under which, or less, it gave way [N]; 0 it has not.
    """

    cell_m: float
    p_W: np.ndarray
    height_m: np.ndarray
    std_m: np.ndarray
    age_s: np.ndarray
    held_n: np.ndarray
    collapsed_n: np.ndarray
