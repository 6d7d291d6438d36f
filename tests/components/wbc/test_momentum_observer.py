"""The momentum observer against closed forms: a constant push, its limits, and what it must not see."""

import numpy as np
import pytest

from surefoot.components.wbc.momentum_observer import MomentumObserver
from surefoot.config.robot import GRAVITY
from surefoot.config.wbc import Wbc

MASS, DT = 25.0, 0.004
CARRIED = np.array([0.0, 0.0, MASS * GRAVITY, 0.0, 0.0, 0.0])


def pushed(observer, push, seconds, start=0.0):
    """A body whose feet carry its weight and nothing more is pushed: momentum grows by the push."""
    for step in range(round(seconds / DT)):
        observer.update(np.array(push) * (start + (step + 1) * DT), CARRIED, DT)


def test_a_constant_push_is_found_with_the_time_constant_of_the_gain():
    observer = MomentumObserver(Wbc(observer_gain=10.0), MASS)
    push = np.array([20.0, -10.0, 15.0, 2.0, -3.0, 1.0])
    observer.update(np.zeros(6), CARRIED, DT)
    pushed(observer, push, 0.1)
    np.testing.assert_allclose(observer.wrench_W, (1.0 - np.exp(-1.0)) * push, rtol=0.03)
    pushed(observer, push, 1.0, start=0.1)
    np.testing.assert_allclose(observer.wrench_W, push, rtol=1e-3)


def test_it_never_claims_more_than_its_limits():
    settings = Wbc()
    observer = MomentumObserver(settings, MASS)
    pushed(observer, [500.0, 0.0, -500.0, 50.0, 0.0, -50.0], 2.0)
    force = settings.observer_force_share * MASS * GRAVITY
    moment = settings.observer_moment_max
    assert observer.wrench_W == pytest.approx([force, 0.0, -force, moment, 0.0, -moment], abs=1e-6)


def test_what_happens_while_it_is_frozen_is_not_taken_for_a_push():
    observer = MomentumObserver(Wbc(), MASS)
    push = np.array([0.0, 0.0, -6.0, 0.0, 0.0, 0.0])
    pushed(observer, push, 2.0)
    before = observer.wrench_W.copy()
    observer.freeze()
    jumped = np.array([3.0, 0.0, -4.0, 1.0, 1.0, 0.0])
    for step in range(200):
        observer.update(jumped + push * step * DT, CARRIED, DT)
    np.testing.assert_allclose(observer.wrench_W, before, atol=0.1)
