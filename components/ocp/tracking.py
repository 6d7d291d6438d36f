"""Eq. (2): quadratic tracking of reference states, inputs, foot positions and velocities (Sec. II-B.4)."""

from __future__ import annotations

import numpy as np

from surefoot.components.ocp.layout import JOINTS, MOMENTUM, NX, POSITION, ROTATION
from surefoot.components.ocp.quadratic_model import QuadraticModel
from surefoot.components.ocp.term import Nodes
from surefoot.components.robot_model.rotations import log_rotations
from surefoot.config.ocp import Weights

_EYE3 = np.eye(3)


class Tracking:
    """1/2 |x - x_d|_Q + 1/2 |u - u_d|_R + 1/2 |p_i - p_ref|_Wp + 1/2 |v_i - v_ref|_Wv.

    The reference momentum and joint velocities are zero. Foot velocities are inputs of swing legs only:
    a stance foot's is zero by eq. (3). At the last node only the state counts, momentum and base scaled.
    """

    name = "tracking"

    def __init__(self, weights: Weights):
        self._weights = weights
        self.Q = np.concatenate(
            [
                weights.linear_momentum,
                weights.angular_momentum,
                weights.base_position,
                weights.base_rotation,
                np.tile(weights.joints, 4),
            ]
        )
        self.Q_end = self.Q * np.repeat([weights.terminal_scale, 1.0], 12)
        self._R_dq = np.tile(weights.joint_velocity, 4)

    def value(self, nodes: Nodes) -> np.ndarray:
        weights = self._weights
        error, force, foot, velocity = self._residuals(nodes)
        return 0.5 * (
            (self.Q * error[:-1] ** 2).sum(axis=1)
            + weights.force * (force**2).sum(axis=(1, 2))
            + (self._R_dq * nodes.iterate.v[:, 6:] ** 2).sum(axis=1)
            + weights.foot_position * (foot**2).sum(axis=(1, 2))
            + weights.foot_velocity * (velocity**2).sum(axis=(1, 2))
        )

    def add(self, nodes: Nodes, model: QuadraticModel) -> None:
        weights = self._weights
        error, force, foot, velocity = self._residuals(nodes)
        model.x_slope[:-1] += self.Q * error[:-1]
        model.x_bend[:-1] += self.Q
        model.x_slope[-1] += self.Q_end * error[-1]
        model.x_bend[-1] += self.Q_end
        model.u_slope += weights.force * force + weights.foot_velocity * velocity
        share = np.where(nodes.reference.contact[: nodes.N], weights.force, weights.foot_velocity)
        model.u_bend += share[..., None, None] * _EYE3
        model.dq_slope += self._R_dq * nodes.iterate.v[:, 6:]
        model.dq_bend += self._R_dq
        model.place_slope[:, :4] += weights.foot_position * foot
        model.place_bend[:, :4] += weights.foot_position * _EYE3

    def violation(self, nodes: Nodes) -> float:
        return 0.0

    def _residuals(self, nodes: Nodes):
        iterate, reference, N = nodes.iterate, nodes.reference, nodes.N
        stance = reference.contact[:N, :, None]
        return (
            _state_error(iterate, reference),
            stance * (iterate.force_W - reference.force_W[:N]),
            nodes.linear.p_WF - reference.p_WF[:N],
            ~stance * (iterate.foot_velocity_W - reference.v_WF[:N]),
        )


def _state_error(iterate, reference) -> np.ndarray:
    """x - x_d in the tangent, (N+1, 24)."""
    error = np.empty((len(iterate.h), NX))
    error[:, MOMENTUM] = iterate.h
    np.subtract(iterate.p_WB, reference.p_WB, out=error[:, POSITION])
    error[:, ROTATION] = log_rotations(reference.R_WB.swapaxes(1, 2) @ iterate.R_WB)
    error[:, JOINTS] = (iterate.q - reference.q).reshape(len(error), 12)
    return error
