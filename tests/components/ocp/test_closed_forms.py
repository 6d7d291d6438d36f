"""Statics of probing: what eqs. (5) and (6) with Table I balance to, on paper before on a robot."""

import numpy as np
import pinocchio as pin
import pytest
from scipy.optimize import minimize
from standing import LEGS, ROBOT, WEIGHT, standing

from surefoot.components.ocp.layout import MOMENTUM
from surefoot.components.ocp.problem import Problem
from surefoot.components.ocp.relaxed_barrier import RelaxedBarrier
from surefoot.components.robot_model import build_model
from surefoot.config.ocp import Ocp

MODEL = build_model(ROBOT)
FEET = standing()[0].p_WF[0]
LENGTH, WIDTH = (FEET.max(axis=0) - FEET.min(axis=0))[:2]
DIAGONAL = LENGTH * WIDTH / np.hypot(LENGTH, WIDTH)  # of a foot from the opposite diagonal, nominal stance [m]
SUPPORT = RelaxedBarrier(100.0, 0.02)  # Table I's; the default is a wall
PROBE, CONE = (RelaxedBarrier(each.mu, each.delta) for each in (Ocp().probing_force, Ocp().friction_cone))
FRICTION = Ocp().friction


def static_forces(probe_n, inside_m):
    """Normal forces (probing foot, opposite, each neighbour) with the CoM `inside_m` behind the diagonal."""
    opposite = probe_n + WEIGHT * inside_m / DIAGONAL
    return np.array([probe_n, opposite, *(2 * [0.5 * (WEIGHT - probe_n - opposite)])])


def static_limit(inside_m):
    """The most that a foot can press: its neighbours carry nothing."""
    return 0.5 * WEIGHT * (1.0 - inside_m / DIAGONAL)


def standing_with(leg, probe_n, inside_m):
    """Nodes of the robot at rest under those forces, its centre of mass where they balance it."""
    reference, _ = standing(1)
    order = [leg, 3 - leg, *(other for other in range(4) if other not in (leg, 3 - leg))]
    forces = np.zeros((4, 3))
    forces[order, 2] = static_forces(probe_n, inside_m)
    reference.force_W[:] = forces
    reference.support_leg[:] = leg
    center = forces[:, 2] @ FEET[:, :2] / WEIGHT
    for _ in range(6):  # the legs' own mass moves with the base: a few rounds place the whole
        q = np.concatenate([reference.p_WB[0], [0.0, 0.0, 0.0, 1.0], reference.q[0].ravel()])
        reference.p_WB[:, :2] += center - pin.centerOfMass(MODEL, MODEL.createData(), q)[:2]
        reference.q[:] = LEGS.inverse(reference.p_WF - reference.p_WB[:, None])[0]
    problem = Problem(Ocp(), ROBOT, 1)
    return problem, problem.linearise(problem.cold_start(reference), reference)


@pytest.mark.parametrize("leg", range(4))
@pytest.mark.parametrize("inside_m", [0.0, 0.02, 0.04])
def test_the_forces_on_paper_hold_the_robot_still_that_far_inside_the_polygon(leg, inside_m):
    limit = static_limit(inside_m)
    assert static_forces(limit, inside_m)[2] == pytest.approx(0.0, abs=1e-9)
    for probe_n in (60.0, limit):
        problem, nodes = standing_with(leg, probe_n, inside_m)
        np.testing.assert_allclose(nodes.linear.c[0, MOMENTUM], 0.0, atol=1e-9)
        # Eq. (5) is violated by what the margin asks for beyond the distance inside.
        nodes.reference.support_margin_m = inside_m + 0.010
        assert problem.violations(nodes)["support_polygon"] == pytest.approx(0.010, abs=1e-6)


def balance(asked_n, margin_m, reg_n2, support=True):
    """(probing force, distance of the CoM inside the diagonal) that minimise the barriers' sum."""

    def cost(z):
        probe, inside = z
        forces = static_forces(probe, inside)
        total = PROBE.value(probe - asked_n) + PROBE.value(asked_n - probe)
        total += CONE.value(FRICTION * forces - np.sqrt(reg_n2)).sum()
        total += 0.5e-3 * ((forces - WEIGHT / 4) ** 2).sum()
        if support:
            total += SUPPORT.value(np.array(inside - margin_m))
        return float(total)

    start = [0.8 * asked_n, margin_m]
    found = minimize(cost, start, method="Nelder-Mead", options={"xatol": 1e-7, "fatol": 1e-9, "maxiter": 5000})
    return found.x


@pytest.mark.parametrize("asked_n", [100.0, 110.0, 120.0])
@pytest.mark.parametrize("margin_m", [0.02, 0.04])
@pytest.mark.parametrize(("reg_n2", "least", "most"), [(1.0, 0.04, 0.135), (25.0, 0.07, 0.16)])
def test_table_i_balances_to_a_shortfall_with_the_centre_of_mass_inside(asked_n, margin_m, reg_n2, least, most):
    # 4 to 13 % with a sharp cone, 7 to 16 % with a rounder one; the neighbours keep what the cone asks of them.
    probe, inside = balance(asked_n, margin_m, reg_n2)
    assert least < 1.0 - probe / asked_n < most
    assert 0.010 < inside < 0.055
    assert static_forces(probe, inside)[2] > np.sqrt(reg_n2) / FRICTION


def test_without_eq_5_the_force_is_met_and_the_centre_of_mass_leaves():
    probe, inside = balance(120.0, 0.04, 1.0, support=False)
    assert abs(probe - 120.0) < 1.5
    assert inside < 0.0
