"""How hard a foot can press, against the closed form and the equations of statics."""

import numpy as np
import pytest

from surefoot.components.fsm.static_limit import static_limit

WEIGHT = 241.7
FEET = np.array([[0.24, 0.134, 0.0], [0.24, -0.134, 0.0], [-0.24, 0.134, 0.0], [-0.24, -0.134, 0.0]])
H = 2.0 * 0.24 * 0.134 / np.hypot(0.24, 0.134)


@pytest.mark.parametrize("inside_m", [0.0, 0.02, 0.04])
@pytest.mark.parametrize("leg", range(4))
def test_on_a_rectangle_it_is_half_the_weight_less_what_the_margin_costs(leg, inside_m):
    expected = 0.5 * WEIGHT * (1.0 - inside_m / H)
    assert static_limit(FEET, leg, inside_m, WEIGHT) == pytest.approx(expected, rel=1e-9)


@pytest.mark.parametrize("leg", range(4))
def test_at_the_limit_foot_and_opposite_foot_balance_a_mass_at_the_margin(leg):
    feet = FEET + np.array([[0.1, 0.01, 0], [0.0, 0.02, 0], [-0.03, 0, 0], [0.05, 0.01, 0]])
    limit, opposite = static_limit(feet, leg, 0.03, WEIGHT), 3 - leg
    com = (limit * feet[leg, :2] + (WEIGHT - limit) * feet[opposite, :2]) / WEIGHT
    start, end = (feet[other, :2] for other in range(4) if other not in (leg, opposite))
    normal = np.array([start[1] - end[1], end[0] - start[0]]) / np.hypot(*(end - start))
    side = np.sign(normal @ (feet[opposite, :2] - start))
    assert side * normal @ (com - start) == pytest.approx(0.03)


def test_a_partner_close_to_the_diagonal_leaves_little_and_one_within_the_margin_nothing():
    feet = np.array([[1.537, 0.145, 0], [1.366, -0.154, 0], [0.853, 0.136, 0], [1.145, -0.153, 0]])
    assert 30.0 < static_limit(feet, 0, 0.04, WEIGHT) < 45.0
    assert static_limit(feet, 0, 0.12, WEIGHT) == 0.0


def test_feet_on_one_side_of_the_diagonal_bear_no_press():
    feet = FEET.copy()
    feet[3] = [0.2, 0.13, 0.0]
    assert static_limit(feet, 0, 0.0, WEIGHT) == 0.0
