"""An IMU whose figures stay the same is stuck: that shows in a driven robot."""

from dataclasses import replace

import numpy as np
from gate_cycles import DAMPING, ROBOT, SETTINGS, STILL, at, brakes, cycles

from surefoot.hw.gate.check import Check
from surefoot.hw.gate.gate import Gate
from surefoot.hw.gate.imu_watch import ImuWatch


def test_it_is_stuck_after_more_cycles_than_the_limit():
    watch = ImuWatch(5)
    found = [watch.violation(STILL, driven=True) for _ in range(8)]
    assert [violation is None for violation in found] == [True] * 6 + [False] * 2
    assert found[6].check is Check.IMU and "6 cycles, limit 5" in found[6].found


def test_any_figure_that_changes_is_enough():
    watch, acc = ImuWatch(5), STILL.acc_B
    readings = [replace(STILL, acc_B=acc + [0.0, 1e-9 * (cycle % 5 == 4), 0.0]) for cycle in range(50)]
    assert not any(watch.violation(reading, driven=True) for reading in readings)


def test_a_robot_that_lies_may_be_still():
    watch = ImuWatch(5)
    assert not any(watch.violation(STILL, driven=False) for _ in range(50))


def test_the_gate_damps_and_stays_so():
    gate = Gate(ROBOT, SETTINGS)
    cycles(gate, 0.0, 0.1, at)
    for t in np.arange(0.1, 0.1 + 0.002 * (SETTINGS.gate.imu_stuck_cycles + 3), 0.002):
        law = gate.law(at(t), STILL, t)
    assert brakes(law) and gate.reason.startswith("stopped (gyroscope and accelerometer have not changed")
    assert cycles(gate, 1.0, 1.1, at), "a live IMU again is no reason to go on"
    cycles(gate, 1.1, 1.2, lambda t: at(t, **DAMPING))
    assert not cycles(gate, 1.2, 1.3, at)
