"""What probing has found out about the ground: the loads it has borne, and those under which it gave way."""

from __future__ import annotations

from math import ceil

import numpy as np

from surefoot.bus.messages import FsmEvent, StateEstimate
from surefoot.components.elevation_map.torus import Torus

_LEAST_N = 1.0
"""A load that is not known counts as this: the ground gave way under a foot that hardly pressed."""


class LoadLayer:
    """Layers `held_n` and `collapsed_n` of a torus; 0 where nothing is known.

    A hold under a small load does not undo a collapse under a greater one: both are kept, the largest load that
    has held and the least under which the ground gave way.
    """

    def __init__(self, torus: Torus, foot_radius_m: float):
        """Every verdict counts for the disc that a foot of this radius covers."""
        self._torus = torus
        self._held, self._collapsed = torus.add("held_n", 0.0), torus.add("collapsed_n", 0.0)
        reach = ceil(foot_radius_m / torus.cell_m)
        steps = np.arange(-reach, reach + 1)
        self._around = np.stack(np.meshgrid(steps, steps, indexing="ij"), axis=-1).reshape(-1, 2)
        self._radius = foot_radius_m

    def note(self, event: FsmEvent, estimate: StateEstimate | None) -> None:
        """Take in a verdict of the state machine; other events say nothing of the ground.

        Args:
            event: any event.
            estimate: the newest one, for the force on a foot whose ground gave way after it was accepted.
        """
        if event.kind in ("force_held", "accepted"):
            self._mark_held(event.p_WF, event.held_n)
        elif event.kind in ("collapse", "late_collapse"):
            load = event.asked_n or event.held_n
            if not load and estimate is not None and event.leg >= 0:
                load = float(estimate.force_W[event.leg] @ estimate.normal_W)
            self._mark_collapsed(event.p_WF, max(load, _LEAST_N))

    def _mark_held(self, p_WF: np.ndarray, load_n: float) -> None:
        at = self._disc(p_WF)
        held = self._held.reshape(-1)
        held[at] = np.maximum(held[at], load_n)

    def _mark_collapsed(self, p_WF: np.ndarray, load_n: float) -> None:
        at = self._disc(p_WF)
        collapsed = self._collapsed.reshape(-1)
        collapsed[at] = np.where(collapsed[at] > 0.0, np.minimum(collapsed[at], load_n), load_n)

    def _disc(self, p_WF: np.ndarray) -> np.ndarray:
        """Flat places of the cells whose centre is under the foot, its own cell in any case."""
        own = self._torus.cells(p_WF[:2])
        cells = own + self._around
        near = np.linalg.norm(self._torus.places(cells) - p_WF[:2], axis=1) <= self._radius
        return self._torus.find(cells[near | (cells == own).all(axis=1)])[1]
