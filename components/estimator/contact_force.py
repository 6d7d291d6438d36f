"""Eq. (7): the force under each foot, from joint torques alone."""

from __future__ import annotations

import numpy as np
import pinocchio as pin

from surefoot.components.robot_model import build_model
from surefoot.config.robot import Robot

_DAMPING = 1e-9 * np.eye(3)  # [m^2]


class ContactForce:
    """f_i = -(J_i^T)^-1 (tau_i - h_i), eq. (7), quasi-static, with the joints' identified friction in h_i.

    A motor's torque estimate does not know of the friction between it and the joint; left out, friction
    alone reads as 3 N at the foot.
    """

    def __init__(self, robot: Robot, friction_speed: float):
        self._model = build_model(robot)
        self._data = self._model.createData()
        self._q = pin.neutral(self._model)
        self._v = np.zeros(18)
        self._coulomb = np.array(robot.per_joint("friction"))
        self._damping = np.array(robot.per_joint("damping"))
        self._friction_speed = friction_speed

    def bias(self, R_WB: np.ndarray, quat_WB: np.ndarray, omega_B: np.ndarray, q: np.ndarray, dq: np.ndarray):
        """h (12,): gravity, Coriolis, centrifugal and friction torques [N m]."""
        self._q[3:6], self._q[6] = quat_WB[1:], quat_WB[0]
        self._q[7:] = q
        self._v[3:6], self._v[6:] = omega_B, dq
        h = pin.nonLinearEffects(self._model, self._data, self._q, self._v)[6:]
        return h + self._damping * dq + self._coulomb * np.tanh(dq / self._friction_speed)

    @staticmethod
    def force(J_B: np.ndarray, tau: np.ndarray, bias: np.ndarray) -> np.ndarray:
        """Ground reaction on the four feet in the base frame.

        Args:
            J_B: (4, 3, 3) foot Jacobians in the base [m/rad].
            tau: (12,) motor torques [N m].
            bias: (12,) h of eq. (7) [N m].

        Returns:
            (4, 3) forces [N]; finite on a straight leg too, though nothing is to be made of them there.
        """
        Jt = J_B.transpose(0, 2, 1)
        right = (bias - tau).reshape(4, 3, 1)
        # Damped least squares: exact to 1e-6 in any posture short of a straight leg.
        return np.linalg.solve(J_B @ Jt + _DAMPING, J_B @ right)[..., 0]
