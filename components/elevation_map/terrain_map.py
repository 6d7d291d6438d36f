"""The map: heights from the camera and loads from the feet, on one grid that moves with the robot."""

from __future__ import annotations

from typing import Any

import numpy as np

from surefoot.bus.messages import DepthFrame, ElevationGrid, FsmEvent, MotionReference, StateEstimate
from surefoot.components.elevation_map.depth_points import points_of, view_of
from surefoot.components.elevation_map.height_drift import height_drift
from surefoot.components.elevation_map.heights import Heights
from surefoot.components.elevation_map.load_layer import LoadLayer
from surefoot.components.elevation_map.patch import Patch
from surefoot.components.elevation_map.torus import Torus
from surefoot.config.elevation_map import ElevationMap

_SEEN = ("height", "variance", "seen_t", "doubted", "doubts", "passed")
_LOADS = ("held_n", "collapsed_n")


class TerrainMap:
    """What is known of the ground around the robot, in the frame of the state estimate.

    Attributes:
        drift_m: by how much all heights have been moved to agree with the feet, in sum [m].
        seen_t: time of the last image [s]; None before the first.
    """

    def __init__(self, settings: ElevationMap, foot_radius_m: float):
        self._settings, self._radius = settings, foot_radius_m
        self._torus = Torus(settings.cell_m, settings.length_m, settings.width_m)
        self._heights = Heights(settings, self._torus)
        self._loads = LoadLayer(self._torus, foot_radius_m)
        self._base = np.zeros(
            0
        )  # x, y, z of the base and the variance of its height at the last image; empty: none
        self.drift_m = 0.0
        self.seen_t: float | None = None

    def clear(self) -> None:
        """Forget everything: the frame in which it was known is gone."""
        self._torus.clear()
        self._base, self.drift_m, self.seen_t = np.zeros(0), 0.0, None

    def follow(self, p_WB: np.ndarray) -> None:
        """Keep the robot in the middle."""
        self._torus.move_to(p_WB[:2])

    def note(self, event: FsmEvent) -> None:
        """Take in what the state machine has found out about the ground."""
        self._loads.note(event)

    def see(self, frame: DepthFrame, estimate: StateEstimate, reference: MotionReference | None) -> None:
        """Take in an image; `estimate` is of the same time."""
        settings = self._settings
        drift = height_drift(self._torus, estimate, reference, self._radius, settings.drift_max_m)
        self._grow(estimate, told=drift is not None)
        if drift is not None:
            self.drift_m += settings.drift_gain * drift
            self._heights.shift(settings.drift_gain * drift)
        view = view_of(frame, estimate)
        self._heights.fuse(points_of(view, estimate, settings.range_noise_m), frame.t)
        self._heights.see_through(view, frame.t)
        self.seen_t = frame.t

    def patch(self, p_W: np.ndarray, half_x: int, half_y: int, t: float) -> Patch:
        """2 half_x + 1 by 2 half_y + 1 cells around the one that a place (2,) [m] lies in, at time `t` [s]."""
        first = self._torus.cells(p_W[:2]) - np.array([half_x, half_y])
        return self._cut(first, (2 * half_x + 1, 2 * half_y + 1), t)

    def message(self, t: float) -> ElevationGrid:
        """The whole map."""
        patch = self._cut(self._torus.first, self._torus.shape, t)
        return ElevationGrid(
            t=t,
            valid=True,
            cell_m=patch.cell_m,
            p_W=patch.p_W,
            drift_m=self.drift_m,
            **{
                name: getattr(patch, name).astype(np.float32)
                for name in ("height_m", "std_m", "age_s", "held_n", "collapsed_n")
            },
        )

    def snapshot(self, heights: bool) -> dict[str, Any]:
        """The state by name; without `heights` only where loads are known."""
        layers = self._torus.layers
        cells = np.flatnonzero((layers["held_n"] > 0.0) | (layers["collapsed_n"] > 0.0))
        state: dict[str, Any] = {"first": self._torus.first, "cells": cells, "drift": self.drift_m}
        state |= {name: layers[name].reshape(-1)[cells] for name in _LOADS}
        if heights:
            state |= {name: layers[name] for name in _SEEN}
            state["t"] = np.array([] if self.seen_t is None else [self.seen_t])
            state["base"] = self._base
        return state

    def restore(self, state: dict[str, Any]) -> None:
        """Take over what `snapshot` gave."""
        self.clear()
        layers = self._torus.layers
        self._torus.first = np.array(state["first"])
        self.drift_m = float(state["drift"])
        for name in _LOADS:
            layers[name].reshape(-1)[state["cells"]] = state[name]
        for name in _SEEN:
            if name in state:
                layers[name][:] = state[name]
        for t in state.get("t", ()):
            self.seen_t = float(t)
        self._base = np.array(state.get("base", ()))

    def _grow(self, estimate: StateEstimate, told: bool) -> None:
        """Old heights are less certain by how far the base has drifted since the last image, if no foot tells."""
        last, self._base = self._base, np.append(estimate.p_WB, estimate.covariance[2, 2])
        if len(last):
            moved = self._base - last
            way = float(np.linalg.norm(moved[:3]))
            drifted = 0.0 if told else max(float(moved[3]), 0.0)
            self._heights.grow(self._settings.motion_m**2 * way + drifted)

    def _cut(self, first: np.ndarray, shape: tuple[int, int], t: float) -> Patch:
        layers = self._torus.block(first, shape)
        return Patch(
            cell_m=self._torus.cell_m,
            p_W=self._torus.places(first),
            height_m=layers["height"],
            std_m=np.sqrt(layers["variance"]),
            age_s=t - layers["seen_t"],
            held_n=layers["held_n"],
            collapsed_n=layers["collapsed_n"],
        )
