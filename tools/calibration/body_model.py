"""The robot's model at rest or slowly moving, its attitude known by where gravity points."""

from __future__ import annotations

import numpy as np
import pinocchio as pin

from surefoot.components.robot_model import LegKinematics, build_model
from surefoot.config.robot import GRAVITY, Robot

_UP_W = np.array([0.0, 0.0, 1.0])


def normal_gains(J_B: np.ndarray, normal_B: np.ndarray) -> np.ndarray:
    """n^T J^-T: how much normal force a joint's torque is worth, eq. (7).

    Args:
        J_B: (4, 3, 3) foot Jacobians [m/rad].
        normal_B: (3,) unit vector n.

    Returns:
        (4, 3), of each foot to one N m of each of its joints [1/m].
    """
    return np.linalg.solve(J_B, np.broadcast_to(normal_B, (4, 3))[..., None])[..., 0]


class BodyModel:
    """Kinematics, statics and inverse dynamics; `up_B` (3,) is the unit vector against gravity in the trunk.

    Attributes:
        weight: of the whole robot [N].
        friction: (12,) Coulomb friction of the robot's file [N m].
    """

    def __init__(self, robot: Robot):
        self._model = build_model(robot)
        self._data = self._model.createData()
        self._legs = LegKinematics(robot)
        self.weight = robot.mass * GRAVITY
        self.friction = np.array(robot.per_joint("friction"))

    def feet(self, q: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """Foot centres (4, 3) [m] and their Jacobians (4, 3, 3) [m/rad] in the trunk, of joint angles (12,)."""
        legs = q.reshape(4, 3)
        return self._legs.position(legs), self._legs.jacobian(legs)

    def leg_lengths(self, up_B: np.ndarray, q: np.ndarray) -> np.ndarray:
        """(4,) how far each foot is below its hip [m]."""
        return (self._legs.hip_B - self.feet(q)[0]) @ up_B

    def torques(self, up_B: np.ndarray, q: np.ndarray, dq: np.ndarray, ddq: np.ndarray) -> np.ndarray:
        """(12,) tau = M ddq + C dq + g: what joints without friction need while the trunk is held [N m]."""
        v, a = np.concatenate([np.zeros(6), dq]), np.concatenate([np.zeros(6), ddq])
        return pin.rnea(self._model, self._data, self._configuration(up_B, q), v, a)[6:]

    def vertical_forces(self, up_B: np.ndarray, q: np.ndarray, tau: np.ndarray) -> np.ndarray:
        """(4,) n^T J^-T (g - tau), eq. (7) at rest: what the torques (12,) say that each foot bears [N]."""
        _, J_B = self.feet(q)
        rest = self.torques(up_B, q, np.zeros(12), np.zeros(12)) - tau
        return (normal_gains(J_B, up_B) * rest.reshape(4, 3)).sum(axis=1)

    def level(self, up_B: np.ndarray, q: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """Feet (4, 2) and centre of mass (2,) in a level frame at the trunk's origin [m]."""
        R_LB = pin.Quaternion.FromTwoVectors(up_B, _UP_W).matrix()
        com_W = pin.centerOfMass(self._model, self._data, self._configuration(up_B, q))
        return (self.feet(q)[0] @ R_LB.T)[:, :2], com_W[:2]

    def _configuration(self, up_B: np.ndarray, q: np.ndarray) -> np.ndarray:
        """(19,) the trunk's origin at zero, its heading any."""
        return np.concatenate([np.zeros(3), pin.Quaternion.FromTwoVectors(up_B, _UP_W).coeffs(), q])
