"""The way of a foot from where it is to many places at once."""

from __future__ import annotations

import numpy as np

from surefoot.bus.messages import MotionReference
from surefoot.components.gait.swing_spline import SwingSpline
from surefoot.config.fsm import Fsm

_SAMPLES = 15
"""Points on a swing: those of a step of 30 cm are no farther apart than a cell of 2 cm."""


class SwingPath:
    """Points of the swing spline to any number of ends.

    A swing's height is linear in the heights of its start, end and apex, so that three swings tell all.
    """

    def __init__(self, settings: Fsm):
        self._apex_m = settings.swing_height_m

        def profile(end: float, height: float) -> np.ndarray:
            reference = MotionReference(
                swing_t1=settings.swing_s,
                swing_to=np.array([1.0, 0.0, end]),
                swing_height=height,
                swing_v_lift=settings.swing_v_lift,
                swing_v_touch=settings.swing_v_touch,
                normal_W=np.array([0.0, 0.0, 1.0]),
            )
            times = settings.swing_s * np.arange(1, _SAMPLES + 1) / (_SAMPLES + 1)
            return SwingSpline(reference).sample(times)[0]

        rest, risen, ended = profile(0.0, 0.0), profile(0.0, 1.0), profile(1.0, 0.0)
        self._along, self._by_speeds = rest[:, 0], rest[:, 2]
        self._by_apex = risen[:, 2] - self._by_speeds
        self._by_end = ended[:, 2] - self._by_speeds - self._by_apex

    def points(self, p_from: np.ndarray, p_to: np.ndarray, normal_W: np.ndarray) -> np.ndarray:
        """(n, s, 3) foot centres along the swings from (3,) to each of (n, 3), ends left out [m], in W."""
        rise = (p_to - p_from) @ normal_W
        along = p_to - p_from - rise[:, None] * normal_W
        apex = np.maximum(rise, 0.0) + self._apex_m
        height = self._by_speeds + np.multiply.outer(apex, self._by_apex) + np.multiply.outer(rise, self._by_end)
        return p_from + self._along[:, None] * along[:, None] + height[..., None] * normal_W
