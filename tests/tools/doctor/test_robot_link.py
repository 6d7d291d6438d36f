"""The exchange with a robot, as figures; whom it asks and with what is in `test_examination.py`."""

from collections import Counter
from dataclasses import replace

import numpy as np
import pytest
from packet_samples import drawn_state

from surefoot.config.aliengo import Aliengo
from surefoot.config.doctor import Doctor
from surefoot.hw.aliengo.link_statistics import LinkStatistics
from surefoot.tools.doctor.check import Level
from surefoot.tools.doctor.robot_link import check_link
from surefoot.tools.doctor.talk import Heard

GOOD = LinkStatistics(
    commands=600, states=600, duplicates=0, old=0, checksum_errors=0, refused=0, socket_errors=0, overruns=0,
    rate_hz=500.0, loss=0.0, latency_ms=0.6, latency_max_ms=2.0, trouble="",
)  # fmt: skip


def heard(ticks_a_second=1e6, **statistics):
    state = drawn_state(np.random.default_rng(1))
    states = [replace(state, tick=round(t * ticks_a_second) % 2**32) for t in (4294.0, 4295.2)]
    return Heard("G1", Counter({771: 600}), states, [10.0, 11.2], statistics=replace(GOOD, **statistics))


def found(heard, **wire):
    return {finding.check: finding for finding in check_link(heard, Aliengo(**wire), Doctor())}


def test_a_sound_link_is_well():
    assert {finding.level for finding in found(heard()).values()} == {Level.OK}
    assert len(found(heard())) == 7


@pytest.mark.parametrize(
    ("pace", "unit", "level", "words"),
    [
        (1e6, "auto", Level.OK, "us, 1000000 a second"),
        (1e3, "auto", Level.OK, "ms, 1000 a second"),
        (1e3, "us", Level.FAIL, "ms, 1000 a second"),
        (1e5, "auto", Level.WARN, "neither us nor ms"),
        (1e5, "none", Level.OK, "neither us nor ms"),
    ],
)
def test_the_unit_of_the_tick_is_told_by_its_pace_also_where_it_wraps(pace, unit, level, words):
    tick = found(heard(pace), tick_unit=unit)["tick"]
    assert tick.level is level and words in tick.found


def test_a_tick_that_stands_is_a_failure():
    stuck = heard()
    stuck.states[1:] = []
    assert found(stuck)["tick"].level is Level.FAIL


@pytest.mark.parametrize(
    ("statistics", "check", "level", "words"),
    [
        ({"rate_hz": 490.0}, "rate", Level.WARN, "490 answers"),
        ({"rate_hz": 250.0, "overruns": 300}, "rate", Level.FAIL, "300 cycles left out here"),
        ({"loss": 0.02}, "loss", Level.WARN, "2.0 % of 600"),
        ({"loss": 0.3}, "loss", Level.FAIL, "30.0 % of 600"),
        ({"latency_ms": 3.0}, "latency", Level.WARN, "3.00 ms"),
        ({"latency_ms": 12.0}, "latency", Level.FAIL, "12.00 ms"),
        ({"checksum_errors": 1}, "damaged", Level.WARN, "1 packets, 0.2 %"),
        ({"refused": 300}, "damaged", Level.FAIL, "300 packets, 50.0 %"),
    ],
)
def test_a_bad_link_is_told_with_what_to_do(statistics, check, level, words):
    finding = found(heard(**statistics))[check]
    assert finding.level is level and words in finding.found and finding.remedy


def test_a_machine_that_is_late_is_not_blamed_on_the_cable():
    assert "this machine is late" in found(heard(loss=0.3, overruns=300))["loss"].remedy
    assert "cable" in found(heard(loss=0.3))["loss"].remedy


def test_what_is_no_aliengo_is_said_to_be_none():
    strange = Heard("G1", Counter({12: 3}), trouble="length of a G1 state packet = 12 bytes")
    told = found(strange)
    assert told["answer"].level is told["generation"].level is Level.FAIL
    assert "neither G0 nor G1: 12 bytes" in told["generation"].found
