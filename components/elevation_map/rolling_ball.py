"""How low a ball may come over a map."""

from __future__ import annotations

from math import ceil, sqrt

import numpy as np


class RollingBall:
    """A ball of a radius over the centre of any cell, and the columns that the cells around it are.

    The gap from the centre of a cell to a cell k away is k - 1/2 cells. A ball that is elsewhere in its cell is
    taken to be at the centre: of the clearance that its radius holds, half a cell's diagonal may be lost.

    Attributes:
        half: cells from the middle one to the farthest that it may touch.
    """

    def __init__(self, radius_m: float, cell_m: float):
        self.half = ceil(radius_m / cell_m + 0.5)
        # Shifts of the map by the square of their gap: what is as near is raised alike.
        rings: dict[float, list[tuple[int, int]]] = {}
        for i in range(-self.half, self.half + 1):
            for j in range(-self.half, self.half + 1):
                gaps = (max(abs(k) - 0.5, 0.0) for k in (i, j))
                square = cell_m**2 * sum(gap * gap for gap in gaps)
                if square < radius_m**2 or i == j == 0:
                    rings.setdefault(square, []).append((i + self.half, j + self.half))
        self._rings = [(sqrt(radius_m**2 - square), shifts) for square, shifts in rings.items()]

    def lowest_centre(self, height_m: np.ndarray) -> np.ndarray:
        """(n, m) the least height of the ball's centre over each cell of a map (n, m) [m].

        Grey-scale dilation by the ball. Unknown ground is no obstacle; where all is unknown it is -inf.
        """
        n, m = height_m.shape
        padded = np.full((n + 2 * self.half, m + 2 * self.half), -np.inf)
        np.fmax(height_m, -np.inf, out=padded[self.half : self.half + n, self.half : self.half + m])
        lowest = np.full((n, m), -np.inf)
        for rise, shifts in self._rings:
            highest = np.full((n, m), -np.inf)
            for i, j in shifts:
                np.maximum(highest, padded[i : i + n, j : j + m], out=highest)
            highest += rise
            np.maximum(lowest, highest, out=lowest)
        return lowest
