"""Cells around the robot whose storage wraps round: moving with the robot clears strips and copies nothing."""

from __future__ import annotations

import numpy as np

_FARTHEST = 2.0**60
"""Cells from the world's origin; a place beyond counts as there: a larger number is no integer of 64 bits."""


class Torus:
    """A window of n by m cells on the world's grid; the cell (i, j) of the world is stored at (i mod n, j mod m).

    Cell (i, j) reaches from i to i + 1 along the world's x and from j to j + 1 along y, in cells.

    Attributes:
        cell_m: side of a cell [m].
        shape: (n, m).
        first: (2,) the window's first cell in the world.
        layers: arrays (n, m) by name, in order of storage; written to in place.
    """

    def __init__(self, cell_m: float, length_m: float, width_m: float):
        self.cell_m = cell_m
        self.shape = max(round(length_m / cell_m), 1), max(round(width_m / cell_m), 1)
        self.first = np.zeros(2, np.int64)
        self.layers: dict[str, np.ndarray] = {}
        self._blank: dict[str, float] = {}

    def add(self, name: str, blank: float, dtype: type = np.float64) -> np.ndarray:
        """A new layer, `blank` everywhere and in every cell that becomes new."""
        self.layers[name], self._blank[name] = np.full(self.shape, blank, dtype), blank
        return self.layers[name]

    def clear(self) -> None:
        """Forget every cell."""
        for name, layer in self.layers.items():
            layer[:] = self._blank[name]

    def move_to(self, p_W: np.ndarray) -> None:
        """Centre the window on a place (2,) [m]; cells that come in are blank."""
        before, self.first = self.first, self.cells(p_W) - np.array(self.shape) // 2
        for axis, (old, new, count) in enumerate(
            zip(before.tolist(), self.first.tolist(), self.shape, strict=True)
        ):
            if new == old:
                continue
            come_in = range(max(new, old + count), new + count) if new > old else range(new, min(old, new + count))
            strip = np.array(come_in) % count
            for name, layer in self.layers.items():
                layer[(slice(None), strip) if axis else strip] = self._blank[name]

    def cells(self, p_W: np.ndarray) -> np.ndarray:
        """(..., 2) cells of the world that places (..., 2) [m] lie in."""
        return np.clip(np.floor(np.asarray(p_W) / self.cell_m), -_FARTHEST, _FARTHEST).astype(np.int64)

    def places(self, cells: np.ndarray) -> np.ndarray:
        """(..., 2) centres of cells (..., 2) of the world [m]."""
        return (np.asarray(cells) + 0.5) * self.cell_m

    def find(self, cells: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """Which cells (k, 2) of the world are in the window, (k,), and the flat places of those that are."""
        n, m = self.shape
        i, j = cells[:, 0] - self.first[0], cells[:, 1] - self.first[1]
        inside = (i >= 0) & (i < n) & (j >= 0) & (j < m)
        cells = cells[inside]
        return inside, (cells[:, 0] % n) * m + cells[:, 1] % m

    def stored(self, flat: np.ndarray) -> np.ndarray:
        """(k, 2) cells of the world that are stored at flat places (k,)."""
        where = np.stack(np.divmod(flat, self.shape[1]), axis=1)
        return self.first + (where - self.first) % self.shape

    def block(self, first: np.ndarray, shape: tuple[int, int]) -> dict[str, np.ndarray]:
        """Copies of all layers over a block of the world's cells, x by y; blank outside the window."""
        reach = [np.arange(start, start + count) for start, count in zip(first.tolist(), shape, strict=True)]
        inside = [
            (r >= start) & (r < start + n)
            for r, start, n in zip(reach, self.first.tolist(), self.shape, strict=True)
        ]
        at = np.ix_(*(r % n for r, n in zip(reach, self.shape, strict=True)))
        out = ~np.logical_and.outer(*inside)
        copies = {name: layer[at] for name, layer in self.layers.items()}
        for name, copy in copies.items():
            copy[out] = self._blank[name]
        return copies
