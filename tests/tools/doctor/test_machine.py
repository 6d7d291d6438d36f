"""This machine, made up; and the one the test runs on, which is only looked at."""

import sys
from dataclasses import replace
from math import inf

import numpy as np
import pytest

from surefoot.config.deployment import Deployment, Run
from surefoot.config.doctor import Doctor
from surefoot.tools.doctor.check import Level
from surefoot.tools.doctor.machine import Machine, check_machine, look_at_machine

LATE = np.full(600, 5e-5)
GOOD = Machine(
    rt_priority=80, may_nice=False, memory_lock=inf, resolution_s=1e-9, lateness_s=LATE, cores=8, load=0.4,
    governors=frozenset({"performance"}), free_bytes=10**11, versions=(("numpy", "2.4.6", "2.4.6"),),
)  # fmt: skip
REAL_TIME = Run(clock="monotonic")


def found(machine, run=REAL_TIME):
    return {finding.check: finding for finding in check_machine(machine, run, Doctor())}


def late(ms, share):
    return np.where(np.arange(600) < share * 600, 1e-3 * ms, 5e-5)


def test_a_machine_in_order_is_well():
    assert {finding.level for finding in found(GOOD).values()} == {Level.OK}
    assert found(replace(GOOD, rt_priority=0, may_nice=True))["real-time priority"].level is Level.OK


@pytest.mark.parametrize(
    ("change", "check", "level", "words"),
    [
        ({"rt_priority": 0}, "real-time priority", Level.WARN, "not permitted"),
        ({"memory_lock": 8 << 20}, "memory lock", Level.WARN, "8 MB"),
        ({"lateness_s": late(1.0, 0.05)}, "timer", Level.WARN, "late by 1.00 ms (p99)"),
        ({"lateness_s": late(9.0, 0.05)}, "timer", Level.FAIL, "late by 9.00 ms (p99)"),
        ({"lateness_s": late(9.0, 0.005)}, "timer", Level.OK, "at most 9.00 ms"),
        ({"resolution_s": 4e-3}, "clock", Level.FAIL, "4000000 ns"),
        ({"cores": 2}, "cores", Level.WARN, "2"),
        ({"load": 7.5}, "load", Level.WARN, "7.50 on 8 cores"),
        ({"governors": frozenset({"powersave", "performance"})}, "CPU governor", Level.WARN, "powersave"),
        ({"governors": frozenset()}, "CPU governor", Level.NOT_HERE, "does not tell"),
        ({"free_bytes": 10**9}, "disk", Level.WARN, "1.0 GB free"),
        ({"free_bytes": 10**7}, "disk", Level.FAIL, "0.0 GB free"),
        ({"versions": (("numpy", "1.0", "2.4.6"),)}, "libraries", Level.WARN, "numpy 1.0, not 2.4.6"),
        ({"versions": (("numpy", "", "2.4.6"),)}, "libraries", Level.FAIL, "numpy missing"),
        ({"versions": ()}, "libraries", Level.WARN, "Python 3"),
        ({"broken": ("wbc: libgomp.so.1: no such file",)}, "libraries", Level.FAIL, "wbc: libgomp.so.1"),
    ],
)
def test_what_is_amiss_is_told_with_what_to_do(change, check, level, words):
    finding = found(replace(GOOD, **change))[check]
    assert finding.level is level and words in finding.found
    assert finding.remedy or level in (Level.OK, Level.NOT_HERE)


def test_where_time_waits_real_time_does_not_matter():
    slow = found(replace(GOOD, rt_priority=0, memory_lock=0, lateness_s=late(9.0, 1.0)), Run(clock="simulated"))
    levels = {check: finding.level for check, finding in slow.items()}
    assert [check for check, level in levels.items() if level is Level.NOT_HERE] == [
        "real-time priority", "memory lock", "timer",
    ]  # fmt: skip
    assert Level.WARN not in levels.values() and Level.FAIL not in levels.values()


def test_this_machine_can_be_looked_at():
    seen = look_at_machine(Deployment(doctor=Doctor(watch_s=0.2)))
    assert seen.cores >= 1 and seen.free_bytes > 0 and (seen.lateness_s >= 0.0).all()
    assert {name: there for name, there, _ in seen.versions}["numpy"] == np.__version__
    assert seen.broken == ()


def test_a_library_that_cannot_be_loaded_is_named_once(monkeypatch):
    monkeypatch.setitem(sys.modules, "pinocchio", None)
    for module in [name for name in sys.modules if name.startswith("surefoot.components.")]:
        monkeypatch.delitem(sys.modules, module)
    (why,) = look_at_machine(Deployment(doctor=Doctor(watch_s=0.2))).broken
    assert "pinocchio" in why
