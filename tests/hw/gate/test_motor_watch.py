"""A motor that does not make what is asked of it is found; noise, delay and its limit are no fault of it."""

from dataclasses import replace

import numpy as np
import pytest
from gate_cycles import GOOD, NOTHING, ROBOT, SETTINGS, STAND, STILL, at, brakes, cycles, entry

from surefoot.config.robot import JOINT_NAMES
from surefoot.hw.gate.check import Check
from surefoot.hw.gate.gate import Gate
from surefoot.hw.gate.motor_watch import MotorWatch
from surefoot.hw.robot_interface import MotorLaw

KNEE = 5  # FR_calf
OWN = SETTINGS.gate
LIMIT = np.array(ROBOT.per_joint("torque_limit"))


def asks(tau):
    """The law of feed-forward alone: (12,) [N m]."""
    return MotorLaw(q=NOTHING, dq=NOTHING, kp=NOTHING, kd=NOTHING, tau=np.array(tau, float))


def found_after(laws, torques):
    """After how many cycles something is found, and what."""
    watch = MotorWatch(ROBOT, OWN)
    for number, (law, tau) in enumerate(zip(laws, torques, strict=True)):
        watch.sent(law)
        if found := watch.violation(replace(STILL, tau=tau), driven=True):
            return number, found
    return None, None


@pytest.mark.parametrize("joint", range(12), ids=lambda joint: JOINT_NAMES[joint])
def test_a_motor_that_is_dead_from_a_cycle_on_is_found_and_named(joint):
    asked = np.where(np.arange(12) % 2, 10.0, -10.0)
    torques = [entry(asked, joint, 0.0 if cycle >= 40 else asked[joint]) for cycle in range(100)]
    number, found = found_after([asks(asked)] * 100, torques)
    assert number == 40 + OWN.motor_off_cycles and found.check is Check.MOTOR
    assert f"motor of {JOINT_NAMES[joint]} makes 0.0 N m where {asked[joint]:.1f} N m are asked" in found.found


def test_a_motor_of_which_little_is_asked_may_be_dead():
    assert found_after([asks(np.full(12, 4.0))] * 100, [NOTHING] * 100) == (None, None)


@pytest.mark.parametrize("delay", [0, 5, 14])
def test_the_law_may_be_as_old_as_the_way_there_and_back_is_long(delay):
    t = 0.002 * np.arange(500)
    waves = 20.0 * np.sin(15.0 * t)[:, None] * np.ones(12)
    late = np.roll(waves, delay, axis=0)
    late[:delay] = waves[0]
    noisy = late + 0.5 * np.random.default_rng(delay).standard_normal(late.shape)
    assert found_after([asks(tau) for tau in waves], list(noisy)) == (None, None)


def test_a_motor_ends_at_its_limit_whatever_is_asked():
    stiff = MotorLaw(q=STAND + 1.0, dq=NOTHING, kp=np.full(12, 500.0), kd=np.ones(12), tau=NOTHING)
    assert found_after([stiff] * 100, [LIMIT] * 100) == (None, None)


@pytest.mark.parametrize("scale", [0.8, 1.2])
def test_an_estimate_may_have_a_scale_of_its_own(scale):
    asked = np.linspace(-30.0, 30.0, 12)
    assert found_after([asks(asked)] * 100, [scale * asked] * 100) == (None, None)


def test_a_moment_is_let_pass():
    torques = [STILL.tau - 20.0 * (cycle % 40 < OWN.motor_off_cycles) for cycle in range(200)]
    assert found_after([asks(STILL.tau)] * 200, torques) == (None, None)


def test_a_robot_that_is_damped_is_not_watched():
    watch = MotorWatch(ROBOT, OWN)
    for _ in range(100):
        watch.sent(asks(np.full(12, 20.0)))
        assert watch.violation(STILL, driven=False) is None


def test_the_gate_damps_and_stays_so_but_not_in_a_dry_run():
    dead = replace(STILL, tau=entry(STILL.tau, KNEE, 0.0))
    hard = entry(GOOD.tau, KNEE, 12.0)
    for dry_run in (False, True):
        gate = Gate(ROBOT, replace(SETTINGS, dry_run=dry_run))
        assert cycles(gate, 0.0, 0.2, lambda t: at(t, tau=hard), dead) is not dry_run
        assert gate.reason.startswith("stopped (motor of FR_calf makes 0.0 N m") is not dry_run
        assert cycles(gate, 0.2, 0.3, at) is not dry_run
        assert brakes(gate.law(at(0.3), STILL, 0.3)) is not dry_run
