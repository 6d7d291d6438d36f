"""One cost or constraint of the problem: its value, and what it adds to the quadratic model."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Protocol

import numpy as np

from surefoot.components.ocp.centroidal_dynamics import Linearisation, Trajectory
from surefoot.components.ocp.node_reference import NodeReference
from surefoot.components.ocp.quadratic_model import QuadraticModel


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

    def add(self, nodes: Nodes, model: QuadraticModel) -> None:
        """Add gradient and Gauss-Newton Hessian to those of what the term is a function of."""

    def violation(self, nodes: Nodes) -> float:
        """How far the worst node is outside, in the constraint's unit; 0 for a cost."""
