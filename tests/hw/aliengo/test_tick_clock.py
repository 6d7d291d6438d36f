"""The robot's tick becomes time on this machine, whatever its unit."""

import numpy as np
import pytest

from surefoot.hw.aliengo.tick_clock import TickClock

WRAP = 2**32


def exchange(clock, ticks_per_s, seconds, first_tick=0, delay=lambda n: 0.0005, begin=100.0):
    """500 states a second; returns when they were measured and what the clock says of that."""
    measured = begin + 0.002 * np.arange(round(500 * seconds))
    told = []
    for n, t in enumerate(measured):
        tick = (first_tick + round(ticks_per_s * (t - begin))) % WRAP
        assert clock.ahead(tick) > 0
        told.append(clock.follow(tick, t + delay(n)))
    return measured, np.array(told)


@pytest.mark.parametrize(("ticks_per_s", "unit"), [(1e6, "us"), (1e3, "ms"), (500.0, ""), (0.9e6, "")])
def test_the_unit_shows_within_seconds(ticks_per_s, unit):
    clock = TickClock("auto")
    assert clock.unit == ""
    exchange(clock, ticks_per_s, 1.5)
    assert clock.unit == unit


def test_the_unit_is_not_told_from_a_second_whose_first_answer_was_late_but_soon_after():
    clock = TickClock("auto")
    exchange(clock, 1e6, 1.2, delay=lambda n: 0.050 if n == 0 else 0.0005)
    assert clock.unit == ""
    clock = TickClock("auto")
    exchange(clock, 1e6, 6.0, delay=lambda n: 0.050 if n == 0 else 0.0005)
    assert clock.unit == "us"


@pytest.mark.parametrize("unit", ["us", "ms"])
def test_a_state_that_was_held_up_is_dated_back(unit):
    clock = TickClock(unit)
    measured, told = exchange(
        clock, {"us": 1e6, "ms": 1e3}[unit], 2.0, delay=lambda n: 0.0005 + 0.030 * (n % 7 == 6)
    )
    np.testing.assert_allclose(told, measured + 0.0005, atol=0.0005)
    assert (np.diff(told) > 0.0).all()


def test_all_that_comes_later_and_later_is_old():
    clock = TickClock("us")
    measured, told = exchange(clock, 1e6, 2.0, delay=lambda n: 0.0005 + (0.1 if n > 500 else 0.0))
    arrived = measured + 0.1005
    assert (arrived[501:] - told[501:] > 0.085).all()


@pytest.mark.parametrize("drift", [-1e-3, 1e-3])
def test_clocks_that_run_apart_do_not_make_states_old(drift):
    clock = TickClock("us")
    measured, told = exchange(clock, 1e6 * (1.0 + drift), 60.0)
    assert np.abs(told - measured).max() < 0.001


def test_without_a_unit_arrival_tells_the_time():
    measured, told = exchange(TickClock("none"), 7.0e5, 0.5, delay=lambda n: 0.003)
    np.testing.assert_array_equal(told, measured + 0.003)
    measured, told = exchange(TickClock("auto"), 1e6, 0.5, delay=lambda n: 0.003)
    np.testing.assert_array_equal(told, measured + 0.003)


def test_repeats_and_old_ticks_are_known_also_where_the_tick_wraps():
    clock = TickClock("us")
    assert clock.ahead(0) == 1
    clock.follow(WRAP - 1, 0.0)
    assert [clock.ahead(tick) for tick in (WRAP - 1, WRAP - 11, 1)] == [0, -10, 2]
    clock.follow(1, 0.002)
    assert [clock.ahead(tick) for tick in (1, WRAP - 1, 2001)] == [0, -2, 2000]
    measured, told = exchange(TickClock("us"), 1e6, 1.0, first_tick=WRAP - 300_000)
    np.testing.assert_allclose(told, measured + 0.0005, atol=0.0001)
