"""The convex region of eq. (4): the largest rectangle of safe cells around a foothold."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

LEAST_CELLS = 2
"""A rectangle narrower than this leaves the optimisation nothing to choose: it shrinks to the foothold's cell."""


@dataclass(frozen=True)
class SafeRectangle:
    """Cells from `first` to `last`, both included; each is an (x, y) index pair."""

    first: tuple[int, int]
    last: tuple[int, int]

    @classmethod
    def around(cls, safe: np.ndarray, cell: tuple[int, int]) -> SafeRectangle:
        """The rectangle of most cells among those that contain `cell` and are safe throughout.

        Its sides run along the map's axes and are of two cells at least, or it is `cell` alone. Of equally
        large ones the one with the longer short side is taken, then the one that begins at the smaller x.

        Args:
            safe: (n, m) whether each cell is; `cell` must be.
            cell: index of the foothold's cell.
        """
        row, column = cell
        left, right = _run(safe[:, column::-1]), _run(safe[:, column:])
        # A run that begins in the foothold's column narrows with every row that joins: least so far, both ways.
        before = [np.minimum.accumulate(run[row::-1]) for run in (left, right)]
        after = [np.minimum.accumulate(run[row:]) for run in (left, right)]
        lefts, rights = (np.minimum(a[:, None], b[None]) for a, b in zip(before, after, strict=True))
        height = np.add.outer(np.arange(len(before[0])), np.arange(len(after[0]))) + 1
        width = lefts + rights - 1
        short = np.minimum(height, width)
        # Ranked by cells, then by the short side, which no side of the grid outgrows.
        rank = np.where(short >= LEAST_CELLS, height * width * (max(safe.shape) + 1) + short, 0)
        if not rank.any():
            return cls(cell, cell)
        rows_before, rows_after = np.unravel_index(_last_of_best(rank), rank.shape)
        i, j = int(rows_before), int(rows_after)
        return cls(
            (row - i, column - int(lefts[i, j]) + 1),
            (row + j, column + int(rights[i, j]) - 1),
        )

    def half_spaces(self, p_W: np.ndarray, cell_m: float) -> tuple[np.ndarray, np.ndarray]:
        """A (4, 3) and b (4,) [m] of eq. (4): A p + b >= 0 for foot centres p in W over the rectangle.

        The rows of A are unit vectors, horizontal and inward: +x, -x, +y, -y. The rectangle ends at the outer
        borders of its cells and not a foot's radius inside: a cell is safe only if the foot's disc may stand
        anywhere in it (`FootDisc`), so the ground beyond the border has been judged already.

        Args:
            p_W: (2,) x, y of the centre of cell [0, 0] [m].
            cell_m: side of a cell [m].
        """
        low = p_W + (np.array(self.first) - 0.5) * cell_m
        high = p_W + (np.array(self.last) + 0.5) * cell_m
        A = np.zeros((4, 3))
        A[0, 0] = A[2, 1] = 1.0
        A[1, 0] = A[3, 1] = -1.0
        return A, np.array([-low[0], high[0], -low[1], high[1]])


def _run(safe: np.ndarray) -> np.ndarray:
    """(n,) how many cells from the first column on are safe without a break, in each row of (n, m)."""
    return np.logical_and.accumulate(safe, axis=1).sum(axis=1)


def _last_of_best(rank: np.ndarray) -> int:
    """Flat index of the largest entry; the last of equal ones, which begins at the smallest x."""
    return rank.size - 1 - int(np.argmax(rank.ravel()[::-1]))
