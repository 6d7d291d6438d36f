"""The gate lets only safe commands near the motors, says why it refuses, and is cleared by a person only."""

from dataclasses import replace

import numpy as np
import pytest
from gate_cycles import DAMPING, GOOD, LAW, NOTHING, ROBOT, SETTINGS, STAND, STILL, at, brakes, cycles, entry

from surefoot.hw.gate.gate import Gate

TILTED = replace(STILL, acc_B=np.array([9.0, 0.0, -4.0]))
BROKEN = replace(STILL, q=entry(STAND, 3, np.nan))


@pytest.fixture
def gate():
    return Gate(ROBOT, SETTINGS)


def test_a_good_command_passes_unchanged(gate):
    law = gate.law(GOOD, STILL, 1.01)
    assert not gate.damping and gate.reason == ""
    for name in LAW:
        np.testing.assert_array_equal(getattr(law, name), getattr(GOOD, name))


@pytest.mark.parametrize(
    ("command", "t", "said"),
    [
        (None, 1.0, "no command yet"),
        (replace(GOOD, valid=False), 1.0, "does not vouch"),
        (GOOD, 1.2, "200.0 ms old, limit 50 ms: is wbc running?"),
        (GOOD, 0.5, "ms old"),
        (replace(GOOD, tau=entry(GOOD.tau, 4, np.nan)), 1.0, "command.tau of FR_thigh is not finite"),
        (replace(GOOD, kp=entry(GOOD.kp, 2, 900.0)), 1.0, "command.kp of FL_calf = 900.0, allowed 0 to 500"),
        (replace(GOOD, kd=entry(GOOD.kd, 2, -1.0)), 1.0, "command.kd of FL_calf = -1.0"),
        (replace(GOOD, q=np.zeros(11)), 1.0, "command.q has shape"),
    ],
)
def test_an_unfit_command_damps_in_the_same_cycle_and_is_named(gate, command, t, said):
    assert brakes(gate.law(command, STILL, t))
    assert gate.damping and said in gate.reason


def test_an_angle_without_a_gain_is_not_worth_a_word(gate):
    gate.law(replace(GOOD, q=NOTHING, kp=NOTHING), STILL, 1.0)
    assert not gate.damping and gate.reason == ""


def test_before_the_first_command_it_waits_as_long_as_it_takes(gate):
    assert cycles(gate, 0.0, 1.0) and gate.reason == "no command yet"
    assert not cycles(gate, 1.0, 1.1, at)


def test_after_a_gap_that_the_posture_survives_it_goes_on_with_the_next_good_command(gate):
    cycles(gate, 0.0, 0.1, at)
    assert cycles(gate, 0.1, 0.29)
    assert not cycles(gate, 0.29, 0.3, at) and gate.reason == ""


@pytest.mark.parametrize(
    ("gone", "said"),
    [(lambda t: at(0.0), "command is 3"), (lambda t: at(t, valid=False), "does not vouch"), (None, "no command")],
)
def test_damped_for_longer_it_refuses_good_commands_and_says_why_and_what_to_do(gate, gone, said):
    cycles(gate, 0.0, 0.1, at)
    cycles(gate, 0.1, 0.32, gone or (lambda t: None))
    assert cycles(gate, 0.32, 1.0, at)
    assert gate.reason.startswith("damped too long to go on (") and said in gate.reason
    assert gate.reason.endswith("): command sit, or damp, then stand")
    assert brakes(gate.law(at(1.0), STILL, 1.0))


def test_cycles_that_were_missed_count_as_damped(gate):
    gate.law(at(0.0), STILL, 0.0)
    gate.law(at(0.0), STILL, 0.3)
    assert cycles(gate, 0.302, 0.4, at)


def test_it_lets_go_when_the_controller_damps_because_it_is_told_to(gate):
    cycles(gate, 0.0, 0.1, at)
    cycles(gate, 0.1, 0.4)
    assert cycles(gate, 0.4, 0.5, lambda t: at(t, **DAMPING | {"solver": "QP failed"}))
    assert cycles(gate, 0.5, 0.6, lambda t: at(t, **DAMPING | {"dq": np.ones(12)}))
    assert cycles(gate, 0.6, 0.7, at)
    assert not cycles(gate, 0.7, 0.8, lambda t: at(t, **DAMPING))
    assert not cycles(gate, 0.8, 0.9, at) and gate.reason == ""


def test_a_latch_is_not_let_go_while_its_cause_is_there_and_the_first_cause_is_told(gate):
    cycles(gate, 0.0, 0.1, at)
    assert cycles(gate, 0.2, 0.3, lambda t: at(t, **DAMPING), TILTED)
    cycles(gate, 0.3, 0.302, lambda t: at(t, valid=False), TILTED)
    assert gate.reason.startswith("stopped (trunk tilts by 1.99 rad, limit 1.00 rad: set the robot upright)")
    assert "then stand; the whole-body controller does not vouch" in gate.reason
    assert cycles(gate, 0.5, 0.6, at)
    assert not cycles(gate, 0.6, 0.61, lambda t: at(t, **DAMPING))


def test_unusable_measurements_hold_the_last_law_for_a_while_and_then_damp(gate):
    held = gate.law(at(0.0), STILL, 0.0)
    for t in (0.002, 0.012, 0.0215):
        assert gate.law(at(t, tau=np.full(12, 9.0)), BROKEN, t) is held
        assert not gate.damping and gate.reason == "measured q of FR_hip = nan: is the link sound?"
    assert brakes(gate.law(at(0.022), BROKEN, 0.022)) and gate.damping
    assert not cycles(gate, 0.024, 0.03, at)
    assert cycles(gate, 0.03, 0.3, at, BROKEN) and cycles(gate, 0.3, 0.4, at)


def test_nothing_is_held_that_an_unfit_command_or_damping_has_ended(gate):
    assert brakes(gate.law(at(0.0), BROKEN, 0.0))
    gate.law(at(0.002), STILL, 0.002)
    assert brakes(gate.law(at(0.004, valid=False), BROKEN, 0.004))
    assert brakes(gate.law(at(0.006), BROKEN, 0.006))


def test_a_cut_leaves_no_torque_at_all_until_it_is_freed_and_then_damps_until_told(gate):
    cycles(gate, 0.0, 0.1, at)
    gate.cut("button A")
    for make in (at, lambda t: at(t, **DAMPING), lambda t: None):
        law = gate.law(make(0.1), STILL, 0.1)
        assert gate.damping and not any(getattr(law, name).any() for name in LAW)
        assert gate.reason.startswith("torque is cut (button A): free the gate when nobody is near the robot")
    gate.damp("button B")
    assert not gate.safe_law.kd.any()
    gate.free()
    assert cycles(gate, 0.102, 0.2, at) and brakes(gate.law(at(0.2), STILL, 0.2))
    assert gate.reason == "stopped (torque was cut): command sit, or damp, then stand"
    assert not cycles(gate, 0.2, 0.21, lambda t: at(t, **DAMPING))
    assert not cycles(gate, 0.21, 0.22, at) and gate.reason == ""


def test_an_operators_damping_is_latched_and_cleared_like_any_other(gate):
    cycles(gate, 0.0, 0.1, at)
    gate.damp("remote")
    assert cycles(gate, 0.1, 0.2, at) and brakes(gate.safe_law)
    gate.free()
    assert cycles(gate, 0.2, 0.3, at)
    assert gate.reason == "stopped (damped by the operator (remote)): command sit, or damp, then stand"
    assert not cycles(gate, 0.3, 0.31, lambda t: at(t, **DAMPING))
    assert not cycles(gate, 0.31, 0.32, at)


def test_a_warning_and_a_limit_are_both_said(gate):
    warm = replace(STILL, temperature=entry(NOTHING, 9, 75.0))
    law = gate.law(replace(GOOD, tau=entry(GOOD.tau, 11, 45.0)), warm, 1.0)
    assert not gate.damping and law.tau[11] == 44.4
    assert "motor of RR_hip has 75 deg C, limit 70: let it rest soon" in gate.reason
    assert "command.tau of RR_calf = 45.00 limited to 44.40" in gate.reason
