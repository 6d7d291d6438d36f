"""The stage-wise QP as a linear-quadratic problem: one backward and one forward sweep.

minimise over x, u: sum_k 1/2 [u; x]' H_k [u; x] + g_k' [u; x] + 1/2 x_N' Q_N x_N + q_N' x_N
subject to x_{k+1} = A_k x_k + B_k u_k + c_k and x_0 given.

With every inequality a relaxed barrier and eq. (3) projected out, this is the whole QP of one SQP iteration.
"""

from __future__ import annotations

from itertools import pairwise

import numpy as np
from scipy.linalg.blas import dgemm, dsymm, dtrsm
from scipy.linalg.lapack import dpotrf


class SolverFailed(RuntimeError):
    """A solver did not give a step; says which, at which stage and why."""


class StageQP:
    """The QP's data in the columns (u, x, 1), so that gradients ride along with Hessians; allocated once.

    Attributes:
        F: (N, nx+1, nu+nx+1) dynamics, (x, 1) of the next stage.
        M: (N, nu+nx+1, nu+nx+1) costs, of which the upper triangles count.
        P_end: (nx+1, nx+1) terminal cost, of which the upper triangle counts.
        x0: (nx,) first state.
        A, B, c, H, g, Q_end, q_end: the parts of these as named above, views. H is positive semidefinite, and
            positive definite in u.
    """

    def __init__(self, N: int, nx: int, nu: int, F: np.ndarray | None = None):
        """Zero costs; `F` shares dynamics that are written elsewhere."""
        n, last = nu + nx + 1, nu + nx
        self.N, self.nx, self.nu = N, nx, nu
        self.F = np.zeros((N, nx + 1, n)) if F is None else F
        self.F[:, nx, last] = 1.0
        self.M, self.P_end, self.x0 = np.zeros((N, n, n)), np.zeros((nx + 1, nx + 1)), np.zeros(nx)
        self.B, self.A, self.c = self.F[:, :nx, :nu], self.F[:, :nx, nu:last], self.F[:, :nx, last]
        self.H, self.g = self.M[:, :last, :last], self.M[:, :last, last]
        self.Q_end, self.q_end = self.P_end[:nx, :nx], self.P_end[:nx, nx]


class Riccati:
    """Solves one `StageQP`, whose data may change between calls."""

    def __init__(self, qp: StageQP):
        self._qp = qp
        nx, nu = qp.nx, qp.nu
        # Transposed, C-ordered arrays are the Fortran-ordered ones that BLAS takes without a copy; the views
        # are made once, as a slice costs as much as a small product.
        self._stages = [
            (F.T, S.T, S.T[:nu, :nu], S.T[nu:, :nu], S.T[nu:, nu:]) for F, S in zip(qp.F, qp.M, strict=True)
        ]
        self._stages.reverse()
        self._W = np.zeros((nx + 1, nu + nx + 1)).T
        path = self._path = np.zeros((qp.N + 1, nu + nx + 1))  # of (u, x, 1)
        path[:, nu + nx] = 1.0
        self._steps = [(now[:nu], now[nu:], now, after[nu:]) for now, after in pairwise(path)]

    def solve(self) -> tuple[np.ndarray, np.ndarray]:
        """States (N+1, nx) and inputs (N, nu) of the minimum. The QP's costs `M` are used up.

        Raises:
            SolverFailed: a stage's input Hessian is not positive definite, or data is not finite.
        """
        qp, W = self._qp, self._W
        N, nu, last, dot = qp.N, qp.nu, qp.nu + qp.nx, np.dot
        P = qp.P_end.T
        gains: list[np.ndarray] = []
        # Of P and S only the lower triangles are read: rounding cannot break a symmetry that is not stored.
        # Arguments by position (side, lower, trans, ..., overwrite): by name they cost a tenth of a product.
        for Ft, S, S_uu, S_xu, S_xx in self._stages:
            dsymm(1.0, P, Ft, 0.0, W, 1, 1, 1)  # W' = P F
            dgemm(1.0, Ft, W, 1.0, S, 0, 1, 1)  # S = M + F' P F, in place
            L, info = dpotrf(S_uu, 1)
            if info != 0:
                k = N - 1 - len(gains)
                raise SolverFailed(
                    f"riccati: the input Hessian of stage {k} of {N} is not positive definite "
                    f"(leading minor {info}); a cost lacks weight on that input, or the data is not finite"
                )
            Y = dtrsm(1.0, L, S_xu, 1, 1, 1)  # Y = S_xu L^-T
            P = dgemm(-1.0, Y, Y, 1.0, S_xx, 0, 1)  # P = S_xx - S_xu S_uu^-1 S_ux
            gains.append(dtrsm(-1.0, L, Y, 1, 1, 0, 0, 1).T)  # K' = -S_xu S_uu^-1
        gains.reverse()
        path = self._path
        path[0, nu:last] = qp.x0
        for K, F, (u, x, now, after) in zip(gains, qp.F, self._steps, strict=True):
            dot(K, x, u)
            dot(F, now, after)
        if not np.isfinite(path).all():
            raise SolverFailed("riccati: the solution is not finite; the problem's data is not")
        return path[:, nu:last].copy(), path[:N, :nu].copy()
