"""The vendor's counter: six cycles above the limit are too many, and each one below takes one back."""

import numpy as np

from surefoot.hw.gate.power_watch import PowerWatch

ONES = np.ones(12)


def trips(watch, *powers):
    """After each of some powers [W], whether it is too much."""
    return [watch.violation(ONES, power / 12.0 * ONES) is not None for power in powers]


def test_the_sixth_cycle_in_a_row_is_one_too_many_and_the_limit_itself_is_allowed():
    assert trips(PowerWatch(600.0), *[601.0] * 7) == [False] * 5 + [True] * 2
    assert not any(trips(PowerWatch(600.0), *[600.0] * 100))


def test_cycles_below_count_back_to_none_and_no_further():
    watch = PowerWatch(600.0)
    assert not any(trips(watch, *[0.0] * 100, *[700.0] * 5, 0.0, 700.0, 0.0, 0.0, 700.0, 700.0))
    assert trips(watch, 700.0) == [True]


def test_after_a_long_overload_it_takes_five_cycles_to_be_well_again():
    watch = PowerWatch(600.0)
    trips(watch, *[700.0] * 1000)
    assert trips(watch, *[0.0] * 5) == [True] * 4 + [False]


def test_all_twelve_motors_count_whichever_way_they_turn():
    for motor in range(12):
        watch = PowerWatch(600.0)
        tau, dq = -601.0 * np.eye(12)[motor], np.eye(12)[motor]
        assert [watch.violation(tau, dq) is not None for _ in range(6)] == [False] * 5 + [True]
