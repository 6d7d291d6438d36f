"""The stage-wise QP as a linear-quadratic problem: one backward and one forward sweep.

minimise over x, u: sum_k 1/2 [u; x]' H_k [u; x] + g_k' [u; x] + 1/2 x_N' Q_N x_N + q_N' x_N
subject to x_{k+1} = A_k x_k + B_k u_k + c_k and x_0 given.

With every inequality a relaxed barrier and eq. (3) projected out, this is the whole QP of one SQP iteration.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from scipy.linalg.lapack import dposv


class SolverFailed(RuntimeError):
    """A solver did not give a step; says which, at which stage and why."""


@dataclass
class StageQP:
    """The QP's data; inputs come first in H and g.

    Attributes:
        A: (N, nx, nx), B: (N, nx, nu), c: (N, nx) dynamics.
        H: (N, nu+nx, nu+nx) positive semidefinite, positive definite in u; g: (N, nu+nx).
        Q_end: (nx, nx), q_end: (nx,) terminal cost.
        x0: (nx,) first state.
    """

    A: np.ndarray
    B: np.ndarray
    c: np.ndarray
    H: np.ndarray
    g: np.ndarray
    Q_end: np.ndarray
    q_end: np.ndarray
    x0: np.ndarray


class Riccati:
    """Solves a `StageQP` of fixed size; its arrays are allocated once.

    In the backward sweep the state is (x, 1), so that gradients ride along with Hessians, and the order is
    (u, x, 1): three products and one Cholesky solve a stage.

    Attributes:
        K: (N, nu, nx+1) feedback and feed-forward, u = K (x, 1).
    """

    def __init__(self, N: int, nx: int, nu: int):
        self.N, self.nx, self.nu = N, nx, nu
        n = nx + 1
        self._F = np.zeros((N, n, nu + n))
        self._F[:, nx, nu + nx] = 1.0
        self._M = np.zeros((N, nu + n, nu + n))
        self.K = np.zeros((N, nu, n))

    def solve(self, qp: StageQP) -> tuple[np.ndarray, np.ndarray]:
        """States (N+1, nx) and inputs (N, nu) of the minimum.

        Raises:
            SolverFailed: a stage's input Hessian is not positive definite, or data is not finite.
        """
        N, nx, nu = self.N, self.nx, self.nu
        F, M = self._F, self._M
        F[:, :nx, :nu] = qp.B
        F[:, :nx, nu : nu + nx] = qp.A
        F[:, :nx, nu + nx] = qp.c
        last = nu + nx
        M[:, :last, :last] = qp.H
        M[:, :last, last] = qp.g
        M[:, last, :last] = qp.g
        P = np.zeros((nx + 1, nx + 1))
        P[:nx, :nx], P[:nx, nx], P[nx, :nx] = qp.Q_end, qp.q_end, qp.q_end
        K = self.K
        for k in range(N - 1, -1, -1):
            Fk = F[k]
            S = M[k] + Fk.T @ (P @ Fk)
            _, gain, info = dposv(S[:nu, :nu], S[:nu, nu:], lower=1)
            if info != 0:
                raise SolverFailed(
                    f"riccati: the input Hessian of stage {k} of {N} is not positive definite "
                    f"(leading minor {info}); a cost lacks weight on that input, or the data is not finite"
                )
            K[k] = -gain
            P = S[nu:, nu:] - S[nu:, :nu] @ gain
            # Rounding breaks the symmetry, and over 80 stages grows into NaN if it is left.
            P = 0.5 * (P + P.T)
        x, u = np.empty((N + 1, nx)), np.empty((N, nu))
        x[0] = qp.x0
        for k in range(N):
            u[k] = K[k, :, :nx] @ x[k] + K[k, :, nx]
            x[k + 1] = qp.A[k] @ x[k] + qp.B[k] @ u[k] + qp.c[k]
        if not np.isfinite(x).all():
            raise SolverFailed("riccati: the solution is not finite; the problem's data is not")
        return x, u
