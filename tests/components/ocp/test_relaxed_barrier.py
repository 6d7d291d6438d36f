"""The barrier is a logarithm inside, a parabola outside, twice differentiable between."""

import numpy as np
import pytest

from surefoot.components.ocp.relaxed_barrier import RelaxedBarrier

TABLE_I = [(10.0, 0.1), (0.1, 0.005), (0.1, 0.01), (0.1, 0.1), (1.0, 0.5), (100.0, 0.02), (0.7, 0.7)]


@pytest.mark.parametrize(("mu", "delta"), TABLE_I)
def test_derivatives_are_those_of_the_value(mu, delta):
    barrier = RelaxedBarrier(mu, delta)
    h = delta * np.array([-3.0, -0.5, 0.3, 0.9, 1.1, 2.0, 10.0])
    step = 1e-5 * delta
    slope = (barrier.value(h + step) - barrier.value(h - step)) / (2 * step)
    np.testing.assert_allclose(barrier.gradient(h), slope, rtol=1e-6)
    bend = (barrier.gradient(h + step) - barrier.gradient(h - step)) / (2 * step)
    np.testing.assert_allclose(barrier.hessian(h), bend, rtol=1e-6)


@pytest.mark.parametrize(("mu", "delta"), TABLE_I)
def test_the_two_parts_meet_with_value_slope_and_curvature(mu, delta):
    barrier = RelaxedBarrier(mu, delta)
    below, above = delta * (1 - 1e-9), delta * (1 + 1e-9)
    for part in (barrier.value, barrier.gradient, barrier.hessian):
        assert part(np.array(below)) == pytest.approx(part(np.array(above)), rel=1e-6)
    assert barrier.value(np.array(2 * delta)) == pytest.approx(-mu * np.log(2 * delta))
