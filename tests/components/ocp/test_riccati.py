"""The sweep finds the minimum that a dense KKT solve and PIQP find."""

import numpy as np
import piqp
import pytest
from scipy import sparse

from surefoot.components.ocp.riccati import Riccati, SolverFailed, StageQP


def problem(N=6, nx=5, nu=3, seed=0):
    rng = np.random.default_rng(seed)
    root = rng.normal(size=(N, nu + nx, nu + nx))
    end = rng.normal(size=(nx, nx))
    qp = StageQP(N, nx, nu)
    qp.A[:] = np.eye(nx) + 0.3 * rng.normal(size=(N, nx, nx))
    qp.B[:] = rng.normal(size=(N, nx, nu))
    qp.c[:] = rng.normal(size=(N, nx))
    qp.H[:] = root @ root.transpose(0, 2, 1) + 0.1 * np.eye(nu + nx)
    qp.g[:] = rng.normal(size=(N, nu + nx))
    qp.Q_end[:] = end @ end.T
    qp.q_end[:] = rng.normal(size=nx)
    qp.x0[:] = rng.normal(size=nx)
    return qp


def dense(qp):
    """Objective (P, q) and equalities (A, b) of the variables (x_0, u_0, x_1, u_1, ..., x_N)."""
    N, nx, nu = qp.B.shape
    n = nx + nu
    size = N * n + nx
    P, q = np.zeros((size, size)), np.zeros(size)
    A, b = np.zeros(((N + 1) * nx, size)), np.zeros((N + 1) * nx)
    order = np.r_[nu:n, 0:nu]  # from (u, x) to (x, u)
    for k in range(N):
        here = slice(k * n, (k + 1) * n)
        P[here, here], q[here] = qp.H[k][np.ix_(order, order)], qp.g[k][order]
        rows = slice((k + 1) * nx, (k + 2) * nx)
        A[rows, k * n : k * n + nx] = -qp.A[k]
        A[rows, k * n + nx : (k + 1) * n] = -qp.B[k]
        A[rows, (k + 1) * n : (k + 1) * n + nx] = np.eye(nx)
        b[rows] = qp.c[k]
    P[-nx:, -nx:], q[-nx:] = qp.Q_end, qp.q_end
    A[:nx, :nx], b[:nx] = np.eye(nx), qp.x0
    return P, q, A, b


def unpack(z, qp):
    N, nx, nu = qp.B.shape
    stages = z[: N * (nx + nu)].reshape(N, nx + nu)
    return np.vstack([stages[:, :nx], z[-nx:]]), stages[:, nx:]


@pytest.mark.parametrize("seed", range(3))
def test_equals_a_dense_kkt_solve(seed):
    qp = problem(seed=seed)
    P, q, A, b = dense(qp)
    m = len(b)
    kkt = np.block([[P, A.T], [A, np.zeros((m, m))]])
    x, u = unpack(np.linalg.solve(kkt, np.concatenate([-q, b]))[: len(q)], qp)
    found_x, found_u = Riccati(qp).solve()
    np.testing.assert_allclose(found_x, x, atol=1e-8)
    np.testing.assert_allclose(found_u, u, atol=1e-8)


def test_equals_piqp_multistage():
    qp = problem(N=20, nx=24, nu=12, seed=4)
    qp.A[:] = np.eye(24) + 0.01 * (qp.A - np.eye(24))
    P, q, A, b = dense(qp)
    solver = piqp.SparseSolver()
    solver.settings.kkt_solver = piqp.KKTSolver.sparse_multistage
    solver.settings.eps_abs = solver.settings.eps_rel = 1e-9
    solver.setup(sparse.csc_matrix(P), q, sparse.csc_matrix(A), b)
    assert solver.solve() == piqp.PIQP_SOLVED
    x, u = unpack(solver.result.x, qp)
    found_x, found_u = Riccati(qp).solve()
    np.testing.assert_allclose(found_x, x, atol=1e-5)
    np.testing.assert_allclose(found_u, u, atol=1e-5)


def test_a_failure_is_named_with_its_stage():
    qp = problem()
    qp.H[3, :3, :3] = -50.0 * np.eye(3)
    qp.H[4:, 3:, 3:] *= 1e-6
    qp.Q_end[:] = 0.0
    with pytest.raises(SolverFailed, match=r"riccati: .* of stage \d of 6"):
        Riccati(qp).solve()
    qp = problem()
    qp.c[2, 0] = np.nan
    with pytest.raises(SolverFailed, match="riccati"):
        Riccati(qp).solve()
