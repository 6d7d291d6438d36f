"""What probing has found out about the ground: the loads it has borne, and those under which it gave way."""

from __future__ import annotations

from math import ceil

import numpy as np

from surefoot.bus.messages import FsmEvent
from surefoot.components.elevation_map.torus import Torus

_LEAST_N = 1.0
"""A load that is not known counts as this: the ground gave way under a foot that hardly pressed."""


class LoadLayer:
    """Layers `held_n` and `collapsed_n` of a torus; 0 where nothing is known.

    A hold under a small load does not undo a collapse under a greater one: both are kept, the largest load that
    has held and the least of those under which, or under less, the ground gave way. A hold under as much as made
    it give way later is a thing of the past.
    """

    def __init__(self, torus: Torus, foot_radius_m: float):
        """Every verdict counts for the disc that a foot of this radius covers."""
        self._torus = torus
        self._held, self._collapsed = torus.add("held_n", 0.0), torus.add("collapsed_n", 0.0)
        reach = ceil(foot_radius_m / torus.cell_m)
        steps = np.arange(-reach, reach + 1)
        self._around = np.stack(np.meshgrid(steps, steps, indexing="ij"), axis=-1).reshape(-1, 2)
        self._radius = foot_radius_m

    def note(self, event: FsmEvent) -> None:
        """Take in a verdict of the state machine; other events say nothing of the ground."""
        if event.kind in ("force_held", "accepted"):
            self._mark_held(event.p_WF, event.held_n)
        elif event.kind == "collapse":
            self._mark_collapsed(event.p_WF, event.asked_n, bears_n=event.asked_n)
        elif event.kind == "late_collapse":
            # It gave way under the most that it has borne or under less: nothing that it held is certain any more.
            self._mark_collapsed(event.p_WF, event.held_n, bears_n=0.0)

    def _mark_held(self, p_WF: np.ndarray, load_n: float) -> None:
        at = self._disc(p_WF)
        held = self._held.reshape(-1)
        held[at] = np.maximum(held[at], load_n)

    def _mark_collapsed(self, p_WF: np.ndarray, load_n: float, bears_n: float) -> None:
        """It gave way under `load_n`; holds of `bears_n` and more are taken back."""
        at, load_n = self._disc(p_WF), max(load_n, _LEAST_N)
        collapsed, held = self._collapsed.reshape(-1), self._held.reshape(-1)
        collapsed[at] = np.where(collapsed[at] > 0.0, np.minimum(collapsed[at], load_n), load_n)
        held[at] = np.where(held[at] < bears_n, held[at], 0.0)

    def _disc(self, p_WF: np.ndarray) -> np.ndarray:
        """Flat places of the cells whose centre is under the foot, its own cell in any case."""
        own = self._torus.cells(p_WF[:2])
        cells = own + self._around
        near = np.linalg.norm(self._torus.places(cells) - p_WF[:2], axis=1) <= self._radius
        return self._torus.find(cells[near | (cells == own).all(axis=1)])[1]
