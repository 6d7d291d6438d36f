"""The local surface normal: a plane through the latest foot contacts (Sec. II-D.1)."""

from __future__ import annotations

from math import sqrt, tan

import numpy as np

from surefoot.components.memory import Memory
from surefoot.config.estimator import Estimator


class SurfaceNormal:
    """Least-squares plane through each foot's latest contact position, low-passed and bounded in tilt.

    Attributes:
        slope: (2,) of the plane along x and y, low-passed.
        normal_W: (3,) unit normal, upwards.
    """

    memory = Memory("slope", "normal_W")

    def __init__(self, settings: Estimator):
        self._gain = settings.normal_filter
        self._slope_max = tan(settings.normal_tilt_max)
        self.slope = np.zeros(2)
        self.normal_W = np.array([0.0, 0.0, 1.0])

    def update(self, contact_WF: np.ndarray) -> np.ndarray:
        """Take in the latest contact positions (4, 3) [m]; returns the normal (3,)."""
        centred = contact_WF - contact_WF.mean(axis=0)
        xy, z = centred[:, :2], centred[:, 2]
        (a, b), (_, c) = xy.T @ xy
        determinant = a * c - b * b
        if determinant > 1e-8:
            r = xy.T @ z
            fit = np.array([c * r[0] - b * r[1], a * r[1] - b * r[0]]) / determinant
            self.slope += self._gain * (fit - self.slope)
            steepness = sqrt(self.slope[0] ** 2 + self.slope[1] ** 2)
            slope = self.slope * min(1.0, self._slope_max / max(steepness, 1e-12))
            length = sqrt(1.0 + slope[0] ** 2 + slope[1] ** 2)
            self.normal_W = np.array([-slope[0], -slope[1], 1.0]) / length
        return self.normal_W
