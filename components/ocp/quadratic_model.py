"""The problem's cost, eq. (1a), to second order, gathered by what its terms are functions of."""

from __future__ import annotations

import numpy as np

from surefoot.components.ocp.centroidal_dynamics import Linearisation
from surefoot.components.ocp.layout import CONFIGURATION, NU, NV, NX, ONE, WIDTH, U, X, diagonals, leg_blocks
from surefoot.components.ocp.riccati import StageQP


class QuadraticModel:
    """Slopes and bends (gradients and Gauss-Newton Hessians) of all terms; the chain rule is applied once.

    A term adds to the slope and bend of what it is a function of; `write` makes the costs of one `StageQP` of
    them. The arrays are allocated once.

    Attributes:
        x_slope, x_bend: (N+1, 24) of single states, the terminal node's too.
        u_slope: (N, 4, 3), u_bend: (N, 4, 3, 3) of the inputs of each leg.
        dq_slope, dq_bend: (N, 12) of single joint velocities.
        place_slope: (N, 5, 3), place_bend: (N, 5, 3, 3) of the places of the four feet and the centre of mass.
    """

    def __init__(self, qp: StageQP):
        N = qp.N
        self.x_slope, self.x_bend = np.zeros((N + 1, NX)), np.zeros((N + 1, NX))
        self.u_slope, self.u_bend = np.zeros((N, 4, 3)), np.zeros((N, 4, 3, 3))
        self.dq_slope, self.dq_bend = np.zeros((N, NU)), np.zeros((N, NU))
        self.place_slope, self.place_bend = np.zeros((N, 5, 3)), np.zeros((N, 5, 3, 3))
        self._dq_rows, self._place_rows = np.empty((N, NU, WIDTH)), np.empty((N, 5, 3, NV + 1))
        M = self._M = qp.M
        self._place_costs = M[:, CONFIGURATION, CONFIGURATION.start :]
        self._u_blocks, self._u_gradient = leg_blocks(M[:, U, U]), M[:, U, ONE].reshape(N, 4, 3)
        self._x_diagonal, self._x_gradient = diagonals(M[:, X, X]), M[:, X, ONE]
        self._end_diagonal, self._end_gradient = diagonals(qp.Q_end[None])[0], qp.q_end

    def clear(self) -> None:
        """Forget what terms have added."""
        for array in (
            self.x_slope, self.x_bend, self.u_slope, self.u_bend,
            self.dq_slope, self.dq_bend, self.place_slope, self.place_bend,
        ):  # fmt: skip
            array.fill(0.0)

    def write(self, linear: Linearisation) -> None:
        """Write the costs of the QP: H = sum J' bend J, g = sum J' slope."""
        N = len(self.dq_bend)
        rows: np.ndarray
        # Slopes stand in the last column of bend J, so that one product gives Hessian and gradient.
        G, rows = linear.V[:, 6:], self._dq_rows
        np.multiply(self.dq_bend[..., None], G, out=rows)
        rows[..., ONE] = self.dq_slope
        np.matmul(G.swapaxes(1, 2), rows, out=self._M)

        J, rows = linear.place_x, self._place_rows
        np.matmul(self.place_bend, J, out=rows[..., :NV])
        rows[..., NV] = self.place_slope
        self._place_costs += J.reshape(N, 15, NV).swapaxes(1, 2) @ rows.reshape(N, 15, NV + 1)

        self._u_blocks += self.u_bend
        self._u_gradient += self.u_slope
        self._x_diagonal += self.x_bend[:N]
        self._x_gradient += self.x_slope[:N]
        self._end_diagonal[:], self._end_gradient[:] = self.x_bend[N], self.x_slope[N]
