"""Eq. (2): quadratic tracking of reference states, inputs, foot positions and foot velocities."""

from __future__ import annotations

import numpy as np

from surefoot.components.ocp.centroidal_dynamics import log_rotations
from surefoot.components.ocp.term import JOINTS, MOMENTUM, POSITION, ROTATION, Nodes, add_foot_rows, add_force_rows
from surefoot.components.ocp.term import add_joint_velocity_rows as add_dq_rows
from surefoot.config.ocp import Weights


class Tracking:
    """1/2 |x - x_d|_Q + 1/2 |u - u_d|_R + 1/2 |p_i - p_ref|_Wp + 1/2 |v_i - v_ref|_Wv.

    The reference momentum and joint velocities are zero. Foot velocities are inputs of swing legs only:
    a stance foot's is zero by eq. (3).
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
        self._R_dq = np.tile(weights.joint_velocity, 4)

    def value(self, nodes: Nodes) -> np.ndarray:
        error, force, dq, foot, velocity = self._residuals(nodes)
        weights = self._weights
        return 0.5 * (
            (self.Q * error**2).sum(axis=1)
            + weights.force * (force**2).sum(axis=(1, 2))
            + (self._R_dq * dq**2).sum(axis=1)
            + weights.foot_position * (foot**2).sum(axis=(1, 2))
            + weights.foot_velocity * (velocity**2).sum(axis=(1, 2))
        )

    def add(self, nodes: Nodes, H: np.ndarray, g: np.ndarray) -> None:
        error, force, dq, foot, velocity = self._residuals(nodes)
        weights, N = self._weights, nodes.N
        g[:, 12:] += self.Q * error
        states = np.arange(12, 36)
        H[:, states, states] += self.Q
        stance = nodes.reference.contact[:N, :, None]
        slope = np.where(stance, weights.force * force, weights.foot_velocity * velocity)
        share = np.where(stance[..., None], weights.force, weights.foot_velocity) * np.eye(3)
        add_force_rows(nodes, slope, share, H, g)
        add_dq_rows(nodes, self._R_dq * dq, np.broadcast_to(self._R_dq, (N, 12)), H, g)
        bend = np.broadcast_to(weights.foot_position * np.eye(3), (N, 4, 3, 3))
        add_foot_rows(nodes, weights.foot_position * foot, bend, H, g)

    def terminal(self, nodes: Nodes) -> tuple[np.ndarray, np.ndarray]:
        """(24, 24) Hessian and (24,) gradient at the last node: scaled on momentum and base."""
        iterate, reference = nodes.iterate, nodes.reference
        scale = np.concatenate([np.full(12, self._weights.terminal_scale), np.ones(12)])
        error = _state_error(iterate, reference, slice(-1, None))[0]
        return np.diag(scale * self.Q), scale * self.Q * error

    def violation(self, nodes: Nodes) -> float:
        return 0.0

    def _residuals(self, nodes: Nodes):
        iterate, reference, N = nodes.iterate, nodes.reference, nodes.N
        stance = reference.contact[:N, :, None]
        return (
            _state_error(iterate, reference, slice(0, N)),
            stance * (iterate.force_W - reference.force_W[:N]),
            iterate.v[:, 6:],
            nodes.linear.p_WF - reference.p_WF[:N],
            ~stance * (iterate.foot_velocity_W - reference.v_WF[:N]),
        )


def _state_error(iterate, reference, at: slice) -> np.ndarray:
    """x - x_d in the tangent, (n, 24)."""
    error = np.empty((len(iterate.h[at]), 36))
    error[:, MOMENTUM] = iterate.h[at]
    error[:, POSITION] = iterate.p_WB[at] - reference.p_WB[at]
    error[:, ROTATION] = log_rotations(reference.R_WB[at].swapaxes(1, 2) @ iterate.R_WB[at])
    error[:, JOINTS] = (iterate.q[at] - reference.q[at]).reshape(len(error), 12)
    return error[:, 12:]
