"""How low a ball may come over a map."""

from __future__ import annotations

from math import ceil, sqrt

import numpy as np


class RollingBall:
    """A ball of a radius whose centre is anywhere in a cell: it must clear every point of the cells around.

    Attributes:
        half: cells from the middle one to the farthest that it may touch.
    """

    def __init__(self, radius_m: float, cell_m: float):
        # Cells k apart have a gap of k - 1: the 3x3 around the ball are as near as its own. Of the rest only the
        # gap matters, so the map is dilated by 3x3 first, and then by the ball with k for the gap.
        reach = max(ceil(radius_m / cell_m - 1e-9) - 1, 0)
        self.half = reach + 1
        rings: dict[int, list[tuple[int, int]]] = {}
        for i in range(-reach, reach + 1):
            for j in range(-reach, reach + 1):
                if cell_m * sqrt(i * i + j * j) < radius_m - 1e-9 or i == j == 0:
                    rings.setdefault(i * i + j * j, []).append((i + self.half, j + self.half))
        self._rings = [(sqrt(radius_m**2 - square * cell_m**2), shifts) for square, shifts in rings.items()]

    def lowest_centre(self, height_m: np.ndarray) -> np.ndarray:
        """(n, m) the least height of the ball's centre over each cell of a map (n, m) [m].

        Grey-scale dilation by the ball. Unknown ground is no obstacle; where all is unknown it is -inf.
        """
        n, m = height_m.shape
        half = self.half
        padded = np.full((n + 2 * half, m + 2 * half), -np.inf)
        np.fmax(height_m, -np.inf, out=padded[half : half + n, half : half + m])
        for axis in (padded, padded.T):
            risen = np.maximum(axis[1:], axis[:-1])
            np.maximum(risen[1:], risen[:-1], out=axis[1:-1])
        lowest = np.full((n, m), -np.inf)
        for rise, shifts in self._rings:
            highest = np.full((n, m), -np.inf)
            for i, j in shifts:
                np.maximum(highest, padded[i : i + n, j : j + m], out=highest)
            highest += rise
            np.maximum(lowest, highest, out=lowest)
        return lowest
