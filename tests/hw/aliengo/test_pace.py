"""An order leaves at once, the robot hears a command in every cycle, and nobody makes it hear more."""

import numpy as np
import pytest

from surefoot.hw.aliengo.deadlines import Deadlines
from surefoot.hw.aliengo.pace import Pace

PERIOD, GAP, TICK = 2.0, 1.0, 0.01


def sent(orders, until=400.0, stalls=()):
    """When commands leave, of a thread that looks every `TICK` but in stalls [(from, to)]; and what was missed."""
    pace, left, missed, waiting = Pace(PERIOD, GAP, 0.0), [], 0, sorted(orders, reverse=True)
    for now in np.arange(0.0, until, TICK):
        if any(begin <= now < end for begin, end in stalls):
            continue
        goes = False
        while waiting and waiting[-1] <= now:
            goes |= pace.order(now)
            waiting.pop()
        if goes or now >= pace.due:
            missed += pace.left(now)
            left.append(now)
    return np.array(left), missed


def test_without_orders_a_command_leaves_in_every_cycle_and_none_is_late_for_another():
    left, missed = sent([])
    np.testing.assert_allclose(np.diff(left), PERIOD, atol=2 * TICK)
    assert len(left) == 200 and missed == 0


def test_orders_in_every_cycle_are_all_there_is_and_none_waits():
    orders = np.arange(5.5, 400.0, PERIOD) + np.random.default_rng(0).uniform(-0.4, 0.4, 198)
    left, _ = sent(orders)
    late = [left[left >= order - TICK].min() - order for order in orders]
    assert max(late) <= TICK and len(left) == len(orders) + 3


@pytest.mark.parametrize("seed", range(5))
def test_of_a_caller_that_is_late_or_leaves_cycles_out_the_robot_hears_no_more_commands_than_cycles(seed):
    rng, deadlines, orders, now = np.random.default_rng(seed), Deadlines(PERIOD, 0.0), [], 0.0
    while now < 390.0:
        orders.append(now + rng.exponential(1.0))
        now = deadlines.following(orders[-1])[0]
    left, _ = sent(orders)
    assert np.diff(left).min() >= GAP - TICK and np.diff(left).max() <= 2 * PERIOD + TICK
    assert len(left) <= 400.0 / PERIOD + 1


def test_a_burst_of_orders_is_one_command_and_its_last_when_the_gap_is_over():
    left, _ = sent([11.5, 11.5, 11.6, 11.7])
    near = left[(left > 11.0) & (left < 16.0)]
    np.testing.assert_allclose(near, [11.5, 12.5], atol=2 * TICK)


def test_what_a_stall_has_swallowed_is_counted_and_not_made_up():
    left, missed = sent([], stalls=[(11.0, 24.9)])
    assert missed == 6 and np.diff(left).max() == pytest.approx(14.9, abs=3 * TICK)
    assert np.diff(left).min() >= GAP and (np.diff(left)[left[1:] > 27.0] < PERIOD + 2 * TICK).all()


def test_a_look_is_taken_when_an_order_could_wait_no_longer():
    pace = Pace(PERIOD, GAP, 0.0)
    pace.order(0.0)
    pace.left(0.0)
    assert [pace.look(now) for now in (0.1, 0.9, 1.0, 3.0)] == [1.0, 1.0, 4.0, 4.0]
    assert not pace.order(0.5) and pace.due == pace.look(0.6) == 1.0
