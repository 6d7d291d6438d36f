"""An angle that stays the same to the last digit says nothing, unless its joint has to move."""

from dataclasses import replace

import numpy as np
import pytest
from gate_cycles import DAMPING, NOTHING, ROBOT, SETTINGS, STAND, STILL, at, brakes, cycles, entry

from surefoot.config.robot import JOINT_NAMES
from surefoot.hw.gate.check import Check
from surefoot.hw.gate.encoder_watch import EncoderWatch
from surefoot.hw.gate.gate import Gate
from surefoot.hw.robot_interface import MotorLaw, damping_law

KNEE = 5  # FR_calf
ONE = np.ones(12)


def holds(q=STAND, kp=30.0):
    return MotorLaw(q=q, dq=NOTHING, kp=kp * ONE, kd=ONE, tau=NOTHING)


@pytest.fixture
def watch():
    return EncoderWatch(SETTINGS.gate)


def found_after(watch, readings, laws, driven=True):
    """After how many readings (n, 12), each under a law, something is found, and what; None, None without."""
    for number, (q, law) in enumerate(zip(readings, laws, strict=True)):
        if found := watch.violation(q, law, driven):
            return number, found
    return None, None


def noise(cycles=100, seed=0):
    return STAND + 1e-4 * np.random.default_rng(seed).standard_normal((cycles, 12))


def moving(joint, rate=0.005, cycles=100):
    """(n, 12) angles, one of which moves by `rate` a cycle [rad]."""
    return STAND + rate * np.outer(np.arange(cycles), np.eye(12)[joint])


def frozen(readings, joint, since=0):
    readings = readings.copy()
    readings[since:, joint] = readings[since, joint]
    return readings


@pytest.mark.parametrize("joint", range(12), ids=lambda joint: JOINT_NAMES[joint])
def test_a_joint_that_is_to_move_and_tells_of_no_motion_is_found(watch, joint):
    laws = [holds(q) for q in moving(joint)]
    number, found = found_after(watch, frozen(noise(), joint, since=10), laws)
    assert number == 10 + SETTINGS.gate.encoder_stuck_cycles + 1 and found.check is Check.ENCODER
    assert (
        f"measured q of {JOINT_NAMES[joint]} = " in found.found and "has not changed for 26 cycles" in found.found
    )


def test_so_is_one_whose_leg_moves_without_it_and_no_other_of_the_leg_is_named(watch):
    number, found = found_after(watch, frozen(noise() - STAND + moving(KNEE - 1), KNEE), [holds(kp=0.0)] * 100)
    assert number == 26 and "FR_calf" in found.found
    others = frozen(noise() - STAND + moving(KNEE + 1), KNEE)
    assert found_after(EncoderWatch(SETTINGS.gate), others, [holds(kp=0.0)] * 100) == (None, None)


def test_a_robot_that_stands_may_read_the_same_angles_for_ever(watch):
    assert found_after(watch, moving(KNEE, rate=0.0), [holds()] * 100) == (None, None)


def test_a_reference_without_a_gain_moves_nothing(watch):
    laws = [holds(q, kp=0.0) for q in moving(KNEE)]
    assert found_after(watch, frozen(noise(), KNEE), laws) == (None, None)


def test_the_last_digit_is_enough_and_a_slow_joint_may_pause_for_as_long_as_is_allowed(watch):
    steps = noise()
    steps[:, KNEE] = STAND[KNEE] + 1e-9 * (np.arange(100) // SETTINGS.gate.encoder_stuck_cycles)
    assert found_after(watch, steps, [holds(q) for q in moving(KNEE)]) == (None, None)


def test_a_gain_that_begins_to_pull_where_the_joint_is_moves_nothing(watch):
    laws = [damping_law(3.0)] * 50 + [holds()] * 50
    assert found_after(watch, moving(KNEE, rate=0.0), laws) == (None, None)


def test_a_damped_robot_is_not_watched(watch):
    readings = frozen(noise() - STAND + moving(KNEE - 1), KNEE)
    assert found_after(watch, readings, [damping_law(3.0)] * 100, driven=False) == (None, None)


def test_the_gate_damps_and_stays_so_and_a_reading_that_comes_again_is_not_counted():
    gate = Gate(ROBOT, SETTINGS)
    for cycle in range(200):  # on a link that is gone for two cycles of three
        t = 0.002 * cycle
        moved = at(t, q=entry(STAND, KNEE, STAND[KNEE] + 0.001 * cycle), tau=STILL.tau)
        alive = replace(STILL, omega_WB_B=np.full(3, 1e-9 * (cycle // 3)))
        law = gate.law(moved, alive, t, age_s=0.002 * (cycle % 3))
        if gate.damping:
            break
    assert brakes(law) and gate.reason.startswith("stopped (measured q of FR_calf") and 25 * 3 <= cycle <= 28 * 3
    assert cycles(gate, 1.0, 1.1, lambda t: at(t)), "it needs a person"
    cycles(gate, 1.1, 1.2, lambda t: at(t, **DAMPING))
    assert not cycles(gate, 1.2, 1.3, at)
