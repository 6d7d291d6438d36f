"""How near the whole-body QP comes to its solution."""

import numpy as np
import piqp
import pytest

from surefoot.components.wbc.whole_body_qp import Task, WholeBodyQp
from surefoot.config.robot import GRAVITY, load_robot
from surefoot.config.wbc import Wbc

ROBOT, SETTINGS = load_robot("aliengo"), Wbc()
NEAR_N = 0.05


@pytest.fixture
def qp():
    """Of a robot that stands."""
    made = WholeBodyQp(ROBOT, SETTINGS)
    q = np.concatenate([[0.0, 0.0, 0.4, 0.0, 0.0, 0.0, 1.0], np.tile(ROBOT.nominal.stand_q, 4)])
    made.update(q, np.zeros(18))
    return made


def tasks(qp, count):
    """The robot leans any way, on three legs or four, and one leg may be asked to press as a probe does."""
    rng = np.random.default_rng(0)
    for _ in range(count):
        stance = np.ones(4, bool)
        stance[rng.integers(4)] = rng.random() < 0.5
        force = rng.uniform([-20.0, -20.0, 0.0], [20.0, 20.0, 120.0], (4, 3)) * stance[:, None]
        weight = np.full(4, SETTINGS.force_weight)
        weight[rng.integers(4)] = SETTINGS.probe_force_weight
        push = rng.uniform(-1.0, 1.0, 6) * [40.0, 40.0, 40.0, 20.0, 20.0, 10.0]
        wrench = push + [0.0, 0.0, qp.mass * GRAVITY, 0.0, 0.0, 0.0]
        yield Task(stance, wrench, force, weight, rng.normal(0.0, 0.5, (4, 3)))


def solution(qp):
    """Forces (4, 3) of the problem that was solved last, as exactly as PIQP gives them."""
    exact = piqp.DenseSolver()
    exact.settings.preconditioner_iter = 0
    exact.settings.eps_abs = exact.settings.eps_rel = exact.settings.eps_duality_gap_rel = 1e-10
    bounds = (qp._lower, qp._upper, qp._box_lower, qp._box_upper)
    exact.setup(qp._P, qp._c, qp._A, qp._b, qp._G, *bounds)
    assert exact.solve() == piqp.PIQP_SOLVED
    return np.array(exact.result.x)[18:].reshape(4, 3)


def test_forces_are_those_of_the_solution(qp):
    far_n = []
    for task in tasks(qp, 200):
        _, force = qp.solve(task)
        far_n.append(np.abs(force - solution(qp) * task.stance[:, None]).max())
    assert max(far_n) < NEAR_N, f"{max(far_n):.2f} N from the solution, {np.argmax(far_n)} of {len(far_n)}"
