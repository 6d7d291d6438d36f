"""The gate lets only safe commands near the motors, and says why it refuses."""

import dataclasses

import numpy as np
import pytest

from surefoot.bus.messages import JointCommand
from surefoot.config.hw import Hw
from surefoot.config.robot import load_robot
from surefoot.hw.gate import Gate

ROBOT = load_robot("aliengo")
GOOD = JointCommand(
    t=1.0,
    valid=True,
    q=np.tile(ROBOT.nominal.stand_q, 4),
    kp=np.full(12, 10.0),
    kd=np.ones(12),
    tau=np.full(12, 3.0),
)


@pytest.fixture
def gate():
    return Gate(ROBOT, Hw())


def test_a_good_command_passes_unchanged(gate):
    law = gate.law(GOOD, 1.01)
    assert not gate.damping and gate.reason == ""
    for name in ("q", "dq", "kp", "kd", "tau"):
        np.testing.assert_array_equal(getattr(law, name), getattr(GOOD, name))


def with_entry(name, index, value):
    values = getattr(GOOD, name).copy()
    values[index] = value
    return dataclasses.replace(GOOD, **{name: values})


@pytest.mark.parametrize(
    ("command", "t", "said"),
    [
        (None, 1.0, "no command yet"),
        (dataclasses.replace(GOOD, valid=False), 1.0, "does not vouch"),
        (GOOD, 1.2, "200.0 ms old, limit 50 ms"),
        (GOOD, 0.5, "ms old"),
        (with_entry("tau", 4, np.nan), 1.0, "command.tau of FR_thigh is not finite"),
        (with_entry("kp", 2, 900.0), 1.0, "command.kp of FL_calf = 900.0, allowed 0 to 500"),
        (with_entry("kd", 2, -1.0), 1.0, "command.kd of FL_calf = -1.0"),
        (dataclasses.replace(GOOD, q=np.zeros(11)), 1.0, "command.q has shape"),
    ],
)
def test_everything_else_damps_in_the_same_cycle_and_is_named(gate, command, t, said):
    law = gate.law(command, t)
    assert gate.damping and said in gate.reason
    assert not law.kp.any() and not law.tau.any() and (law.kd == Hw().damping_kd).all()


def test_torques_and_angles_beyond_the_limits_are_limited_and_named(gate):
    law = gate.law(with_entry("tau", 11, 99.0), 1.0)
    assert law.tau[11] == 44.4 and "RR_calf = 99.00 limited to 44.40" in gate.reason
    assert gate.law(with_entry("q", 2, 0.0), 1.0).q[2] == pytest.approx(-0.645771823)
    assert not gate.damping


def test_an_angle_without_a_gain_is_not_worth_a_word(gate):
    gate.law(dataclasses.replace(GOOD, q=np.zeros(12), kp=np.zeros(12)), 1.0)
    assert not gate.damping and gate.reason == ""


def at(t, **fields):
    return dataclasses.replace(GOOD, t=t, **fields)


NOTHING = np.zeros(12)
DAMPING = {"kp": NOTHING, "tau": NOTHING, "solver": "ok"}


def cycles(gate, t0, t1, make=lambda t: None):
    """Every cycle from t0 to t1 [s], with the command that `make(t)` gives; whether the last one damped."""
    for t in np.arange(t0, t1, 0.002):
        gate.law(make(t), t)
    return gate.damping


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
    assert "command sit, or damp, then stand" in gate.reason
    assert not gate.law(at(1.0), 1.0).kp.any()


def test_cycles_that_were_missed_count_as_damped(gate):
    gate.law(at(0.0), 0.0)
    gate.law(at(0.0), 0.3)
    assert cycles(gate, 0.302, 0.4, at)


def test_it_lets_go_when_the_controller_damps_because_it_is_told_to(gate):
    cycles(gate, 0.0, 0.1, at)
    cycles(gate, 0.1, 0.4)
    assert cycles(gate, 0.4, 0.5, lambda t: at(t, **DAMPING | {"solver": "QP failed"}))
    assert cycles(gate, 0.5, 0.6, lambda t: at(t, **DAMPING | {"dq": np.ones(12)}))
    assert cycles(gate, 0.6, 0.7, at)
    assert not cycles(gate, 0.7, 0.8, lambda t: at(t, **DAMPING))
    assert not cycles(gate, 0.8, 0.9, at) and gate.reason == ""
