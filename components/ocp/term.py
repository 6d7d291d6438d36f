"""One cost or constraint of the problem: its value, and its quadratic model in (u, x)."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Protocol

import numpy as np

from surefoot.components.ocp.centroidal_dynamics import NU, NX, Linearisation, Trajectory
from surefoot.components.ocp.node_reference import NodeReference

U = slice(0, NU)
X = slice(NU, NU + NX)
MOMENTUM, POSITION, ROTATION = slice(12, 18), slice(18, 21), slice(21, 24)
JOINTS = slice(24, 36)


@dataclass
class Nodes:
    """Everything a term may look at: the iterate, its linearisation and the reference."""

    iterate: Trajectory
    linear: Linearisation
    reference: NodeReference

    @property
    def N(self) -> int:
        return len(self.iterate.v)


class Term(Protocol):
    """A cost, or a constraint as a relaxed barrier."""

    name: str

    def value(self, nodes: Nodes) -> np.ndarray:
        """(N,) cost of each node."""

    def add(self, nodes: Nodes, H: np.ndarray, g: np.ndarray) -> None:
        """Add gradient to g (N, 36) and Gauss-Newton Hessian to H (N, 36, 36), in the order (u, x)."""

    def violation(self, nodes: Nodes) -> float:
        """How far the worst node is outside, in the constraint's unit; 0 for a cost."""


def add_foot_rows(nodes: Nodes, slope: np.ndarray, bend: np.ndarray, H: np.ndarray, g: np.ndarray) -> None:
    """Add a function of the foot positions.

    Args:
        slope: (N, 4, 3) its gradient with respect to p_WF.
        bend: (N, 4, 3, 3) its Hessian.
    """
    linear = nodes.linear
    J = np.empty((nodes.N, 4, 3, 9))  # of base position, base rotation, the leg's joints
    J[..., :3] = np.eye(3)
    J[..., 3:6] = linear.foot_rotation
    J[..., 6:] = linear.foot_joint
    Jt = J.swapaxes(-1, -2)
    gradient = (Jt @ slope[..., None])[..., 0]
    hessian = Jt @ (bend @ J)
    g[:, 18:24] += gradient[..., :6].sum(axis=1)
    H[:, 18:24, 18:24] += hessian[..., :6, :6].sum(axis=1)
    for leg in range(4):
        own = slice(24 + 3 * leg, 27 + 3 * leg)
        g[:, own] += gradient[:, leg, 6:]
        H[:, own, own] += hessian[:, leg, 6:, 6:]
        H[:, 18:24, own] += hessian[:, leg, :6, 6:]
        H[:, own, 18:24] += hessian[:, leg, 6:, :6]


def add_force_rows(nodes: Nodes, slope: np.ndarray, bend: np.ndarray, H: np.ndarray, g: np.ndarray) -> None:
    """Add a function of the contact forces: slope (N, 4, 3), bend (N, 4, 3, 3); zero for swing legs."""
    g[:, U] += slope.reshape(nodes.N, 12)
    for leg in range(4):
        own = slice(3 * leg, 3 * leg + 3)
        H[:, own, own] += bend[:, leg]


def add_joint_velocity_rows(
    nodes: Nodes, slope: np.ndarray, bend: np.ndarray, H: np.ndarray, g: np.ndarray
) -> None:
    """Add a sum of functions of single joint velocities: slope and bend (N, 12)."""
    G = np.concatenate([nodes.linear.v_u[:, 6:], nodes.linear.v_x[:, 6:]], axis=2)
    Gt = G.swapaxes(1, 2)
    g += (Gt @ slope[..., None])[..., 0]
    H += Gt @ (bend[..., None] * G)
