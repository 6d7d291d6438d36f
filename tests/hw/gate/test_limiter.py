"""What is too much is taken off exactly, and the rest of the law stays what it was."""

from dataclasses import replace

import numpy as np
import pytest
from gate_cycles import GOOD, LAW, LIMITS, NOTHING, STAND, STILL, entry, torque

from surefoot.hw.gate.check import Check
from surefoot.hw.gate.limiter import Limiter
from surefoot.hw.robot_interface import MotorLaw, damping_law

STEP = 50.0


@pytest.fixture
def limiter():
    return Limiter(LIMITS, STEP)


def law_of(command):
    return MotorLaw(**{name: getattr(command, name) for name in LAW})


def checks(found):
    return [violation.check for violation in found]


def test_a_law_that_makes_too_much_where_the_joint_is_is_scaled_down_to_what_it_may_make(limiter):
    command = replace(GOOD, kp=entry(GOOD.kp, 2, 200.0))
    away = replace(STILL, q=entry(STAND, 2, STAND[2] - 0.5), dq=entry(NOTHING, 2, 2.0))
    law, found = limiter.limited(command, law_of(command), away)
    assert torque(law_of(command), away)[2] == pytest.approx(101.0)
    assert torque(law, away)[2] == pytest.approx(44.4) and checks(found) == [Check.TORQUE]
    assert law.kp[2] / 200.0 == pytest.approx(law.kd[2]) and law.q[2] == STAND[2]
    for name in LAW:
        np.testing.assert_array_equal(np.delete(getattr(law, name), 2), np.delete(getattr(command, name), 2))


def test_too_large_a_step_is_made_in_several_and_arrives(limiter):
    last, command = law_of(replace(GOOD, tau=np.full(12, -33.0))), replace(GOOD, tau=np.full(12, 35.0))
    first, found = limiter.limited(command, last, STILL)
    np.testing.assert_allclose(torque(first, STILL), np.full(12, 17.0))
    assert checks(found) == [Check.TORQUE_STEP]
    second, found = limiter.limited(command, first, STILL)
    np.testing.assert_array_equal(second.tau, command.tau)
    assert found == ()


def test_a_step_from_damping_to_a_stiff_law_is_a_law_between_the_two_at_any_state():
    command = replace(GOOD, q=STAND + 0.1, dq=np.ones(12), kp=np.full(12, 200.0))
    damp, elsewhere = damping_law(3.0), replace(STILL, q=STAND - 0.2, dq=np.full(12, -2.0))
    law, found = Limiter(LIMITS, 6.0).limited(command, damp, STILL)
    assert checks(found) == [Check.TORQUE_STEP]
    for state, whole in ((STILL, 24.0), (elsewhere, 66.0)):
        expected = 0.25 * whole + 0.75 * torque(damp, state)
        np.testing.assert_allclose(torque(law, state), expected)
    np.testing.assert_allclose(law.q, command.q)


def test_what_the_joint_itself_has_moved_is_no_step_of_the_command(limiter):
    stiff = replace(GOOD, kp=np.full(12, 500.0))
    for away in (-0.04, 0.06):
        law, found = limiter.limited(stiff, law_of(stiff), replace(STILL, q=STAND + away))
        assert found == () and law.kp is stiff.kp
