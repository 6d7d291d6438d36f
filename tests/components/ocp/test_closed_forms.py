"""Statics of probing: what eqs. (5) and (6) with Table I balance to, on paper before on a robot."""

import numpy as np
import pytest
from scipy.optimize import minimize

from surefoot.components.ocp.relaxed_barrier import RelaxedBarrier

WEIGHT = 241.7  # [N]
DIAGONAL = 0.234  # of a foot from the opposite diagonal, nominal stance [m]
SUPPORT, PROBE, CONE = RelaxedBarrier(100.0, 0.02), RelaxedBarrier(0.7, 0.7), RelaxedBarrier(10.0, 0.1)
FRICTION = 0.5


def static_forces(probe_n, inside_m):
    """Normal forces (probing foot, opposite, each neighbour) with the CoM `inside_m` behind the diagonal."""
    opposite = probe_n + WEIGHT * inside_m / DIAGONAL
    return np.array([probe_n, opposite, *(2 * [0.5 * (WEIGHT - probe_n - opposite)])])


def corner_positions():
    """Feet of a square whose corners are DIAGONAL from the other diagonal: probe, opposite, neighbours."""
    return DIAGONAL * np.array([[1.0, 0.0], [-1.0, 0.0], [0.0, 1.0], [0.0, -1.0]])


@pytest.mark.parametrize("inside_m", [0.0, 0.02, 0.04])
def test_static_forces_balance_weight_and_moments(inside_m):
    forces = static_forces(100.0, inside_m)
    assert forces.sum() == pytest.approx(WEIGHT)
    center = forces @ corner_positions() / WEIGHT
    np.testing.assert_allclose(center, [-inside_m, 0.0], atol=1e-12)


@pytest.mark.parametrize(
    ("inside_m", "limit_n"), [(0.0, 120.8), (0.02, 110.5), (0.03, 105.3), (0.04, 100.2), (0.05, 95.0)]
)
def test_the_static_limit_is_reached_when_the_neighbours_are_unloaded(inside_m, limit_n):
    limit = 0.5 * WEIGHT * (1.0 - inside_m / DIAGONAL)
    assert limit == pytest.approx(limit_n, abs=0.06)
    assert static_forces(limit, inside_m)[2] == pytest.approx(0.0, abs=1e-9)


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
@pytest.mark.parametrize(("reg_n2", "least", "most"), [(1.0, 0.045, 0.145), (25.0, 0.075, 0.165)])
def test_table_i_balances_to_a_shortfall_with_the_centre_of_mass_inside(asked_n, margin_m, reg_n2, least, most):
    # 5 to 14 % with a sharp cone, 8 to 16 % with a rounder one; the neighbours keep what the cone asks of them.
    probe, inside = balance(asked_n, margin_m, reg_n2)
    assert least < 1.0 - probe / asked_n < most
    assert 0.010 < inside < 0.052
    assert static_forces(probe, inside)[2] > np.sqrt(reg_n2) / FRICTION


def test_without_eq_5_the_force_is_met_and_the_centre_of_mass_leaves():
    probe, inside = balance(120.0, 0.04, 1.0, support=False)
    assert abs(probe - 120.0) < 1.5
    assert inside < 0.0
