"""Only news counts: the newest good state is kept, whatever else comes with it."""

from dataclasses import replace

import numpy as np
import pytest
from packet_samples import PLAUSIBILITY, READING, drawn_state

from surefoot.config.aliengo import Aliengo
from surefoot.hw.aliengo.generation import G0, G1
from surefoot.hw.aliengo.link_statistics import LinkRecorder
from surefoot.hw.aliengo.remote import Button, Remote
from surefoot.hw.aliengo.state_feed import StateFeed
from surefoot.hw.aliengo.state_packet import encode_state
from surefoot.hw.aliengo.tick_clock import TickClock

STATE = drawn_state(np.random.default_rng(12))


def packet(tick, generation=G1, **other):
    return encode_state(replace(STATE, tick=tick, **other), generation, READING)[0]


def damaged(tick):
    bytes_ = bytearray(packet(tick))
    bytes_[100] ^= 4
    return bytes(bytes_)


@pytest.fixture
def recorder():
    return LinkRecorder()


@pytest.fixture
def feed(recorder):
    return StateFeed(Aliengo(), PLAUSIBILITY, recorder, TickClock("none"))


def counts(recorder):
    found = recorder.statistics()
    return found.states, found.duplicates, found.old, found.checksum_errors, found.refused


def test_of_several_the_newest_is_kept(feed, recorder):
    assert feed.newest is None
    assert feed.take([packet(1), packet(2), packet(3)], 5.0)
    assert feed.newest.state.tick == 3 and feed.newest.t == 5.0 and counts(recorder) == (3, 0, 0, 0, 0)


def test_what_every_robot_has_is_told_with_its_time_and_the_motors_temperature(feed):
    feed.take([packet(1)], 5.0)
    sensors = feed.newest.sensors
    assert sensors.t == 5.0
    np.testing.assert_array_equal(sensors.temperature, STATE.temperature)
    np.testing.assert_allclose(sensors.q, STATE.q, atol=1e-6)


def test_repeats_and_what_was_overtaken_are_dropped(feed, recorder):
    feed.take([packet(7)], 1.0)
    assert not feed.take([packet(7), packet(6), packet(2**32 - 1)], 2.0)
    assert feed.newest.t == 1.0 and counts(recorder) == (1, 1, 2, 0, 0)
    assert feed.take([packet(9), packet(8)], 3.0)
    assert feed.newest.state.tick == 9


def test_a_bad_packet_is_named_and_costs_no_good_one(feed, recorder):
    bad = [damaged(1), b"", packet(1, G0), packet(1, dq=np.full(12, 1e6))]
    assert not feed.take(bad, 1.0) and feed.newest is None and counts(recorder) == (0, 0, 0, 1, 3)
    assert "state.dq of FL_hip = 1e+06 rad/s" in recorder.statistics().trouble
    assert feed.take([damaged(2), packet(2), damaged(3)], 2.0)
    assert feed.newest.state.tick == 2 and counts(recorder) == (1, 0, 0, 3, 3)
    assert "checksum" in recorder.statistics().trouble


def test_a_tick_far_ahead_in_a_damaged_packet_does_not_make_the_next_ones_old(feed):
    feed.take([packet(1), damaged(10**9), packet(2)], 1.0)
    assert feed.newest.state.tick == 2


@pytest.mark.parametrize("generation", [G0, G1])
def test_what_the_remote_asks_for_comes_with_the_sensors(generation, recorder):
    feed = StateFeed(Aliengo(generation=generation.name), PLAUSIBILITY, recorder, TickClock("none"))
    feed.take([packet(1, generation, remote=Remote(Button.L2 | Button.B))], 0.0)
    assert feed.newest.sensors.stop == "settle"
    feed.take([packet(2, generation, remote=Remote())], 0.0)
    assert feed.newest.sensors.stop == ""
