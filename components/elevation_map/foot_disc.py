"""Which cells of a map are under a foot whose centre is anywhere in a cell."""

from __future__ import annotations

import numpy as np
from numpy.lib.stride_tricks import sliding_window_view


class FootDisc:
    """The cells under a disc of a radius whose centre lies anywhere in the middle cell.

    A cell belongs to it if the gap between its square and the middle cell's is less than the radius: a cell is
    judged for every point of it at once, so that regions of safe cells need no further margin.

    Attributes:
        half: cells from the middle one to the window's border.
        inside: (2 half + 1, 2 half + 1) whether a cell belongs to the disc.
    """

    def __init__(self, radius_m: float, cell_m: float):
        # A gap of exactly the radius is no contact, whatever the rounding.
        self.half = int(np.ceil(radius_m / cell_m - 1e-9)) if radius_m > 0.0 else 0
        gap_m = cell_m * np.maximum(np.abs(np.arange(-self.half, self.half + 1)) - 1, 0)
        self.inside = np.hypot(gap_m[:, None], gap_m) < radius_m - 1e-9
        self.inside[self.half, self.half] = True

    def cells(self, values: np.ndarray) -> np.ndarray:
        """(n, m, k) the k cells of the disc around each cell of (n + 2 half, m + 2 half) values."""
        return self.windows(values)[..., self.inside]

    def windows(self, values: np.ndarray) -> np.ndarray:
        """(n, m, 2 half + 1, 2 half + 1) the square around each cell of (n + 2 half, m + 2 half) values."""
        return sliding_window_view(values, self.inside.shape)
