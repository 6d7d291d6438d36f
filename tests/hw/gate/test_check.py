"""Every row of the table: what is allowed to the last digit, what is not, the answer, and how long it stays."""

import re
from dataclasses import replace
from math import cos, inf, nextafter, sin

import numpy as np
import pytest
from gate_cycles import (
    DAMPING,
    GOOD,
    LIMITS,
    NOTHING,
    ROBOT,
    SETTINGS,
    STAND,
    STILL,
    at,
    brakes,
    cycles,
    entry,
    torque,
)  # fmt: skip

from surefoot.config.deployment import Deployment
from surefoot.hw.gate.check import Answer, Check, Latch
from surefoot.hw.gate.gate import Gate

T = 0.5
OWN = SETTINGS.gate
CALF = 11  # RR_calf


def command(**fields):
    return {"command": at(T, **fields)}


def sensors(**fields):
    return {"sensors": replace(STILL, **fields)}


def tilted(angle):
    return sensors(acc_B=9.81 * np.array([sin(angle), 0.0, cos(angle)]))


def hot(degrees):
    return sensors(temperature=entry(NOTHING, 1, degrees))


def working(watts):
    return sensors(tau=entry(NOTHING, 1, 50.0), dq=entry(NOTHING, 1, watts / 50.0)) | {"times": 6}


def up(value):
    return nextafter(value, inf)


FROM_REST = {"before": at(0.39, **DAMPING)}
FROM_BELOW = {"before": at(0.39, tau=entry(GOOD.tau, CALF, -10.0))}
STOP = LIMITS.lower[CALF] - OWN.beyond_stop

# For each check a cycle inside its limit, one just outside, and what is said of that one.
ROWS = {
    Check.TILT: (tilted(OWN.tilt_max - 1e-9), tilted(OWN.tilt_max + 1e-9), "trunk tilts by 1.00 rad, limit 1.00"),
    Check.POWER: (working(500.0), working(up(500.0)), "power is 500 W, limit 500 W"),
    Check.IMU: ({"times": 50}, {"times": 51}, "accelerometer have not changed for 51 cycles, limit 50"),
    Check.ENCODER: (
        command(q=entry(STAND, CALF, -1.3)) | {"times": 25}, command(q=entry(STAND, CALF, -1.3)) | {"times": 26},
        "measured q of RR_calf = -1.4545 has not changed for 26 cycles",
    ),
    Check.MOTOR: (
        sensors(tau=entry(STILL.tau, CALF, -4.5)) | {"times": 25},
        sensors(tau=entry(STILL.tau, CALF, -4.5)) | {"times": 26},
        "motor of RR_calf makes -4.5 N m where 3.0 N m are asked of it, for 26 cycles, limit 25: does this motor",
    ),
    Check.HOT: (hot(80.0), hot(up(80.0)), "motor of FL_thigh has 80 deg C, limit 80: let it cool"),
    Check.END_STOP: (
        sensors(q=entry(STAND, CALF, STOP)), sensors(q=entry(STAND, CALF, nextafter(STOP, -inf))),
        "measured q of RR_calf = -2.86, allowed -2.86 to -0.56",
    ),
    Check.SPEED: (
        sensors(dq=entry(NOTHING, CALF, -LIMITS.measured_speed[CALF])),
        sensors(dq=entry(NOTHING, CALF, -up(LIMITS.measured_speed[CALF]))),
        "measured dq of RR_calf = -12.71 rad/s, limit 12.71",
    ),
    Check.ABSENT: (command(), {"command": None}, "no command yet"),
    Check.INVALID: (command(), command(valid=False), "valid = false"),
    Check.OLD: (
        {"command": at(T - 0.05)}, {"command": at(T - 0.05 - 1e-9)}, "command is 50.0 ms old, limit 50 ms: is wbc",
    ),
    Check.SHAPE: (command(), command(tau=np.zeros((12, 1))), "command.tau has shape (12, 1), expected (12,)"),
    Check.NOT_FINITE: (
        command(dq=entry(NOTHING, 0, 1.7e308)), command(dq=entry(NOTHING, 0, inf)),
        "command.dq of FL_hip is not finite",
    ),
    Check.GAINS: (
        command(kd=entry(GOOD.kd, 3, 20.0)), command(kd=entry(GOOD.kd, 3, up(20.0))),
        "command.kd of FR_hip = 20.0, allowed 0 to 20",
    ),
    Check.FIRST: (
        command(q=entry(STAND, 1, STAND[1] + 3.0 - 1e-9)) | FROM_REST,
        command(q=entry(STAND, 1, STAND[1] + 3.0 + 1e-9)) | FROM_REST,
        "first command.q of FL_thigh = 3.73 pulls it from 0.73 with 30.0 N m, limit 30.0 N m",
    ),
    Check.NO_MEASUREMENT: (
        sensors(tau=entry(NOTHING, 4, nextafter(1e6, 0.0))), sensors(tau=entry(NOTHING, 4, 1e6)),
        "measured tau of FR_thigh = 1e+06: is the link sound?",
    ),
    Check.STALE: ({"age_s": 0.03}, {"age_s": up(0.03)}, "measurements are 30.0 ms old, limit 30 ms"),
    Check.ANGLE: (
        command(q=entry(STAND, CALF, LIMITS.upper[CALF])),
        command(q=entry(STAND, CALF, LIMITS.upper[CALF] + 1e-9)),
        "command.q of RR_calf = -0.65 limited to -0.65",
    ),
    Check.RATE: (
        command(dq=entry(NOTHING, CALF, 15.89)), command(dq=entry(NOTHING, CALF, up(15.89))),
        "command.dq of RR_calf = 15.89 limited to 15.89",
    ),
    Check.FEED_FORWARD: (
        command(tau=entry(GOOD.tau, CALF, 44.4)), command(tau=entry(GOOD.tau, CALF, up(44.4))),
        "command.tau of RR_calf = 44.40 limited to 44.40",
    ),
    Check.TORQUE: (
        command(tau=entry(GOOD.tau, CALF, 40.4), dq=entry(NOTHING, CALF, 4.0 - 1e-9)),
        command(tau=entry(GOOD.tau, CALF, 40.4), dq=entry(NOTHING, CALF, 4.0 + 1e-9)),
        "torque of RR_calf = 44.4 N m limited to 44.4 N m",
    ),
    Check.TORQUE_STEP: (
        command(tau=entry(GOOD.tau, CALF, 40.0)) | FROM_BELOW,
        command(tau=entry(GOOD.tau, CALF, up(40.0))) | FROM_BELOW,
        "step of torque of RR_calf = 50.0 N m limited to 50.0 N m",
    ),
    Check.WARM: (hot(70.0), hot(up(70.0)), "motor of FL_thigh has 70 deg C, limit 70: let it rest soon"),
}  # fmt: skip


def last_of(gate, cycle):
    """The law of a cycle of the table, 0.11 s after one in which all was well; the last of several ends at `T`."""
    gate.law(cycle.get("before", at(0.39)), STILL, 0.39)
    command, times = cycle.get("command", at(T)), cycle.get("times", 1)
    for before_s in 0.002 * np.arange(times)[::-1]:
        dated = command and replace(command, t=command.t - before_s)
        law = gate.law(dated, cycle.get("sensors", STILL), T - before_s, cycle.get("age_s", 0.0))
    return law


@pytest.fixture
def gate():
    return Gate(ROBOT, SETTINGS)


def test_no_row_is_left_out():
    assert set(ROWS) | {Check.CUT, Check.STOP} == set(Check)


@pytest.mark.parametrize("check", ROWS, ids=lambda check: check.name)
def test_at_the_limit_a_law_passes_as_it_came(gate, check):
    cycle, _, said = ROWS[check]
    law, given = last_of(gate, cycle), cycle.get("command", at(T))
    assert not gate.damping and said not in gate.reason
    np.testing.assert_array_equal(law.tau, given.tau)
    np.testing.assert_array_equal(law.kp, given.kp)


@pytest.mark.parametrize("check", ROWS, ids=lambda check: check.name)
def test_beyond_it_the_answer_is_the_tables_and_the_reason_is_said(gate, check):
    _, cycle, said = ROWS[check]
    law = last_of(gate, cycle)
    assert said in gate.reason and check.remedy in gate.reason
    assert gate.damping == (check.answer is Answer.DAMP) == brakes(law)
    if check.answer is Answer.HOLD:
        np.testing.assert_array_equal(law.tau, GOOD.tau)
    if check.answer is Answer.CLAMP:
        assert (np.abs(torque(law, STILL)) <= LIMITS.torque + 1e-9).all() and np.abs(law.tau).max() <= 44.4


@pytest.mark.parametrize("check", ROWS, ids=lambda check: check.name)
def test_what_latches_at_once_stays_and_all_else_is_over_with_its_cause(gate, check):
    last_of(gate, ROWS[check][1])
    damps = cycles(gate, T + 0.11, T + 0.13, at) if check is Check.TILT else cycles(gate, T + 0.002, T + 0.02, at)
    assert damps == (check.latch is Latch.AT_ONCE)
    assert gate.reason.startswith("stopped (") == damps
    assert not cycles(gate, T + 0.13, T + 0.14, lambda t: at(t, **DAMPING))
    assert not cycles(gate, T + 0.14, T + 0.15, at) and gate.reason == ""


@pytest.mark.parametrize("check", Check, ids=lambda check: check.name)
def test_a_limit_is_a_setting_or_a_figure_of_the_robot(check):
    for path in re.findall(r"hw\.[a-z_.]+", check.limit):
        value = Deployment()
        for name in path.split("."):
            value = getattr(value, name)
    for figure in re.findall(r"[a-z]+_limit", check.limit):
        assert ROBOT.per_joint(figure)


def test_the_gravest_answers_come_first():
    order = [Answer.CUT, Answer.DAMP, Answer.HOLD, Answer.CLAMP, Answer.WARN]
    places = [order.index(check.answer) for check in Check]
    assert places == sorted(places)


def test_half_the_torque_and_speed_can_be_asked_for():
    gate = Gate(ROBOT, replace(SETTINGS, gate=replace(OWN, torque_share=0.5, speed_share=0.1)))
    gate.law(GOOD, STILL, 1.0)
    assert gate.law(replace(GOOD, tau=np.full(12, 30.0)), STILL, 1.002).tau.tolist() == [17.639, 17.639, 22.2] * 4
    assert brakes(gate.law(GOOD, replace(STILL, dq=np.full(12, 1.6)), 1.004)) and "limit 1.59" in gate.reason
