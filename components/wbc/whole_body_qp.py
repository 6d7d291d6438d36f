"""The whole-body QP: joint accelerations and contact forces that best give a wrench at the centre of mass.

    minimise   |G f - w_d|_S + beta |f - f_mpc| + |J_swing q'' + b - a_d| + eps |q''|
    subject to base dynamics, J_stance q'' + b = a_stance, f_swing = 0, friction pyramid, torque limits

After Fahmi et al. 2019 (reference [19] of the paper), with the MPC's forces as a bias (Sec. III-A).
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import pinocchio as pin
import piqp

from surefoot.components.robot_model import build_model, foot_frame_ids
from surefoot.components.robot_model.rotation import skew
from surefoot.config.robot import Robot
from surefoot.config.wbc import Wbc

_NV, _NF = 18, 12
_NZ = _NV + _NF
_UPPER, _ABOVE = np.triu(np.ones((_NV, _NV), bool)), np.triu(np.ones((_NV, _NV), bool), 1)
"""Of a symmetric matrix what Pinocchio fills, with and without the diagonal."""
_FORCES = np.vstack([np.tile(np.eye(3), 4), np.zeros((3, _NF))])
"""(6, 12) what each force adds to the wrench, without its moment."""


class QpFailed(RuntimeError):
    """PIQP did not solve the whole-body problem; says its status."""


@dataclass(frozen=True)
class Task:
    """What one solve is asked for.

    Attributes:
        stance: (4,) legs in contact.
        wrench_W: (6,) force and moment about the centre of mass, gravity's included [N, N m].
        force_W: (4, 3) the MPC's forces [N].
        force_weight: (4,) their weights.
        foot_acceleration_W: (4, 3) of stance feet (braking) and swing feet (task) [m/s^2].
    """

    stance: np.ndarray
    wrench_W: np.ndarray
    force_W: np.ndarray
    force_weight: np.ndarray
    foot_acceleration_W: np.ndarray


class WholeBodyQp:
    """One robot's QP, set up once and updated in place.

    Attributes:
        com_W: (3,) centre of mass after `update`; inertia_W (3, 3) about it.
        momentum_W: (6,) centroidal momentum, linear and angular [N s, N m s].
        J: (4, 3, 18) foot Jacobians in the world.
    """

    def __init__(self, robot: Robot, settings: Wbc):
        self._settings = settings
        self._model = build_model(robot)
        self._data = self._model.createData()
        self._feet = foot_frame_ids(self._model)
        self.mass = robot.mass
        self._torque_limit = np.array(robot.per_joint("torque_limit"))
        self.J = np.zeros((4, 3, _NV))
        self._bias = np.zeros((4, 3))
        self._P, self._c = np.zeros((_NZ, _NZ)), np.zeros(_NZ)
        self._A, self._b = np.zeros((18, _NZ)), np.zeros(18)
        self._G = np.zeros((28, _NZ))
        self._lower, self._upper = np.full(28, -1e4), np.zeros(28)
        mu = settings.friction
        for leg in range(4):
            x = _NV + 3 * leg
            self._G[4 * leg : 4 * leg + 4, x : x + 3] = [[1, 0, -mu], [-1, 0, -mu], [0, 1, -mu], [0, -1, -mu]]
        self._box_lower, self._box_upper = np.full(_NZ, -1e4), np.full(_NZ, 1e4)
        self._box_lower[_NV + 2 :: 3], self._box_upper[_NV + 2 :: 3] = 0.0, settings.force_max_n
        self._solver: piqp.DenseSolver | None = None

    def update(self, q: np.ndarray, v: np.ndarray) -> None:
        """Dynamics at a configuration q (19) and velocity v (18) of Pinocchio."""
        model, data = self._model, self._data
        pin.forwardKinematics(model, data, q, v, np.zeros(_NV))
        pin.computeJointJacobians(model, data, q)
        pin.updateFramePlacements(model, data)
        M = pin.crba(model, data, q)
        self._M = np.where(_UPPER, M, 0.0) + np.where(_ABOVE, M, 0.0).T
        self._h = pin.nonLinearEffects(model, data, q, v).copy()
        pin.ccrba(model, data, q, v)
        self.com_W = data.com[0].copy()
        self.momentum_W = np.array(data.hg.vector)
        self.inertia_W = np.array(data.Ig.inertia)
        world = pin.LOCAL_WORLD_ALIGNED
        pin.forwardKinematics(model, data, q, v, np.zeros(_NV))
        self.p_WF = np.empty((4, 3))
        for leg, frame in enumerate(self._feet):
            self.J[leg] = pin.getFrameJacobian(model, data, frame, world)[:3]
            self._bias[leg] = pin.getFrameClassicalAcceleration(model, data, frame, world).linear
            self.p_WF[leg] = data.oMf[frame].translation
        self.wrench_map = _FORCES.copy()
        self.wrench_map[3:] = skew(self.p_WF - self.com_W).transpose(1, 0, 2).reshape(3, _NF)

    def solve(self, task: Task) -> tuple[np.ndarray, np.ndarray]:
        """Joint torques (12,) [N m] and forces (4, 3) [N].

        Raises:
            QpFailed: no solution; nothing is replaced.
        """
        self._fill(task)
        if self._solver is None:
            self._solver = piqp.DenseSolver()
            # The default preconditioner calls feasible problems of this scale infeasible.
            self._solver.settings.preconditioner_iter = 0
            setup = self._solver.setup
        else:
            setup = self._solver.update
        setup(
            self._P, self._c, self._A, self._b, self._G, self._lower, self._upper, self._box_lower, self._box_upper
        )
        status = self._solver.solve()
        if status != piqp.PIQP_SOLVED:
            raise QpFailed(f"whole-body QP: {status}")
        z = np.array(self._solver.result.x)
        force = z[_NV:].reshape(4, 3) * task.stance[:, None]
        return self.torques(force, z[:_NV]), force

    def torques(self, force_W: np.ndarray, acceleration: np.ndarray) -> np.ndarray:
        """tau = (M q'' + h - J' f) of the joints, (12,) [N m]."""
        tau = self._M[6:] @ acceleration + self._h[6:]
        for leg in range(4):
            own = slice(3 * leg, 3 * leg + 3)
            tau[own] -= self.J[leg, :, 6 + 3 * leg : 9 + 3 * leg].T @ force_W[leg]
        return tau

    def _fill(self, task: Task) -> None:
        settings, P, c, A, b = self._settings, self._P, self._c, self._A, self._b
        P[:], c[:], A[:], b[:] = 0.0, 0.0, 0.0, 0.0
        accelerations = np.arange(_NV)
        P[accelerations, accelerations] = settings.acceleration_weight
        weighted = np.array(settings.wrench_weight)[:, None] * self.wrench_map
        P[_NV:, _NV:] = self.wrench_map.T @ weighted
        c[_NV:] = -weighted.T @ task.wrench_W
        forces = np.arange(_NV, _NZ)
        share = np.repeat(task.force_weight, 3)
        P[forces, forces] += share
        c[_NV:] -= share * task.force_W.ravel()
        A[:6, :_NV], A[:6, _NV:] = self._M[:6], -self.J[:, :, :6].reshape(_NF, 6).T
        b[:6] = -self._h[:6]
        for leg in range(4):
            rows = slice(6 + 3 * leg, 9 + 3 * leg)
            wanted = task.foot_acceleration_W[leg] - self._bias[leg]
            # f = 0 of a swing leg must not lie on the edge of its own inequalities: a problem without an
            # interior is what an interior-point method calls infeasible.
            on_ground = task.stance[leg]
            self._box_lower[_NV + 3 * leg + 2] = settings.force_min_n if on_ground else -1.0
            self._upper[4 * leg : 4 * leg + 4] = 0.0 if on_ground else 1.0
            if task.stance[leg]:
                A[rows, :_NV], b[rows] = self.J[leg], wanted
            else:
                A[rows, _NV + 3 * leg : _NV + 3 * leg + 3] = np.eye(3)
                P[:_NV, :_NV] += settings.swing_weight * (self.J[leg].T @ self.J[leg])
                c[:_NV] -= settings.swing_weight * (self.J[leg].T @ wanted)
        self._G[16:, :_NV] = self._M[6:]
        for leg in range(4):
            own = slice(16 + 3 * leg, 19 + 3 * leg)
            self._G[own, _NV + 3 * leg : _NV + 3 * leg + 3] = -self.J[leg, :, 6 + 3 * leg : 9 + 3 * leg].T
        self._lower[16:] = -self._torque_limit - self._h[6:]
        self._upper[16:] = self._torque_limit - self._h[6:]
