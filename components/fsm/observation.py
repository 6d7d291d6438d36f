"""What the state machine sees at one instant."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import pinocchio as pin

from surefoot.bus.messages import StateEstimate
from surefoot.components.robot_model import build_model
from surefoot.components.robot_model.rotation import matrix_of, matrix_of_rpy, rpy_of
from surefoot.config.robot import Robot


@dataclass(frozen=True)
class Observation:
    """An estimate, with what the state machine derives from it."""

    t: float  # [s]
    estimate: StateEstimate
    com_W: np.ndarray  # (3,) centre of mass [m]
    rpy: np.ndarray  # (3,) roll, pitch, yaw of the trunk [rad]

    @property
    def pose(self) -> np.ndarray:
        """(6,) base pose: x, y, z [m], roll, pitch, yaw [rad]."""
        return np.concatenate([self.estimate.p_WB, self.rpy])

    @property
    def com_B(self) -> np.ndarray:
        """(3,) centre of mass from the trunk's origin, in the world's axes [m]."""
        return self.com_W - self.estimate.p_WB

    @property
    def up_W(self) -> np.ndarray:
        """(3,) the trunk's upward axis in the world."""
        return matrix_of_rpy(self.rpy)[:, 2]

    def normal_force(self, leg: int) -> float:
        """Estimated force along the local normal on a foot [N]."""
        return float(self.estimate.force_W[leg] @ self.estimate.normal_W)


class Observer:
    """Derives from an estimate what the state machine wants to know besides."""

    def __init__(self, robot: Robot):
        self._model = build_model(robot)
        self._data = self._model.createData()

    def observe(self, t: float, estimate: StateEstimate) -> Observation:
        """The observation at time `t` [s]."""
        w, x, y, z = estimate.quat_WB
        q = np.concatenate([estimate.p_WB, [x, y, z, w], estimate.q])
        com_W = pin.centerOfMass(self._model, self._data, q).copy()
        return Observation(t, estimate, com_W, rpy_of(matrix_of(estimate.quat_WB)))
