"""The swing starts and ends where, and as fast as, it is told, and its derivatives are its own."""

import numpy as np
import pytest

from surefoot.bus.messages import MotionReference
from surefoot.components.gait.swing_spline import SwingSpline

NORMAL = np.array([0.1, 0.0, 1.0]) / np.sqrt(1.01)


def swing(**changes):
    figures = {
        "normal_W": NORMAL,
        "swing_from": np.array([0.2, 0.1, 0.03]),
        "swing_to": np.array([0.3, 0.12, 0.01]),
        "swing_t0": 1.0,
        "swing_t1": 1.8,
        "swing_height": 0.08,
        "swing_v_lift": 0.1,
        "swing_v_touch": 0.1,
    }
    return SwingSpline(MotionReference(**{**figures, **changes}))


def test_it_meets_both_ends_at_the_asked_speeds():
    p, v, a = swing().sample(np.array([1.0, 1.8 - 1e-9]))
    np.testing.assert_allclose(p, [[0.2, 0.1, 0.03], [0.3, 0.12, 0.01]], atol=1e-7)
    np.testing.assert_allclose(v, [0.1 * NORMAL, -0.1 * NORMAL], atol=1e-6)
    np.testing.assert_allclose(a, 0.0, atol=1e-5)


def test_it_clears_the_apex():
    p, _, _ = swing().sample(np.linspace(1.0, 1.8, 801))
    heights = p @ NORMAL
    ends = max(heights[0], heights[-1])
    assert heights.max() == pytest.approx(ends + 0.08, abs=5e-3)


@pytest.mark.parametrize("lands", [True, False])
def test_velocity_and_acceleration_are_derivatives(lands):
    spline, step = swing(swing_lands=lands), 1e-5
    t = np.array([1.05, 1.2, 1.4 - 1e-3, 1.4 + 1e-3, 1.6, 1.75])
    up, down, here = spline.sample(t + step), spline.sample(t - step), spline.sample(t)
    np.testing.assert_allclose(here[1], (up[0] - down[0]) / (2 * step), atol=1e-6)
    np.testing.assert_allclose(here[2], (up[1] - down[1]) / (2 * step), atol=1e-4)


def test_late_contact_is_sought_against_the_normal_and_a_lifted_leg_stays():
    p, v, _ = swing().sample(np.array([2.0]))
    np.testing.assert_allclose(p[0], np.array([0.3, 0.12, 0.01]) - 0.02 * NORMAL, atol=1e-9)
    np.testing.assert_allclose(v[0], -0.1 * NORMAL)
    p, v, _ = swing(swing_lands=False).sample(np.array([0.9, 5.0]))
    np.testing.assert_allclose(p, [[0.2, 0.1, 0.03], [0.3, 0.12, 0.01]], atol=1e-12)
    assert not v.any()
