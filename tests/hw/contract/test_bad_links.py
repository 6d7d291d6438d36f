"""The real robot's driver with an emulator behind a bad link: what gets through is what was sent, or nothing."""

from contextlib import contextmanager
from time import monotonic, sleep

import numpy as np
import pytest
from emulation import emulator
from machines import LEGS_UP, PATIENCE_S, deployment

from surefoot.config.emulator import Fault, Wire
from surefoot.hw.aliengo.backend import open_aliengo
from surefoot.hw.errors import HardwareFault
from surefoot.hw.robot_interface import MotorLaw, damping_law

LAW = MotorLaw(
    q=LEGS_UP.astype(np.float32).astype(float),
    dq=np.zeros(12),
    kp=np.full(12, 100.0),
    kd=np.full(12, 3.0),
    tau=np.arange(12.0),
)
CYCLES = 150


@contextmanager
def talk(**link):
    """The driver, the emulation, and what the robot was asked and has told meanwhile, by tick."""
    with emulator(deployment(**link)) as emulation:
        asked, told = Heard(emulation.robot._motors), Told(emulation.robot)
        driver = open_aliengo(emulation.deployment)
        try:
            yield driver, emulation, asked, told
        finally:
            driver.close()


class Heard:
    """Listens to the commands that motors get."""

    def __init__(self, motors):
        self.laws = []
        follow = motors.command

        def command(command, t):
            self.laws.append(command.law)
            follow(command, t)

        motors.command = command


class Told:
    """Listens to the states that a robot tells."""

    def __init__(self, robot):
        self.states = {}
        answer = robot.answer

        def noted():
            self.states[robot._state.tick] = robot._state
            return answer()

        robot.answer = noted


def exchange(driver, commands=CYCLES):
    """The states that a caller reads while so many commands are sent."""
    read, until = {}, driver.statistics.commands + commands
    while driver.statistics.commands < until:
        driver.write(LAW)
        driver.advance()
        newest = driver.newest.state
        read[newest.tick] = newest
        sleep(0.001)
    return read


def same_law(one, other):
    return all(np.array_equal(getattr(one, name), getattr(other, name)) for name in ("q", "dq", "kp", "kd", "tau"))


def every_command_is_the_law_or_damps(laws):
    assert any(same_law(law, LAW) for law in laws)
    assert all(same_law(law, LAW) or same_law(law, damping_law(3.0)) for law in laws)


def every_reading_is_what_was_measured(read, told):
    assert len(read) > 5
    for tick, state in read.items():
        for name in ("q", "dq", "omega_WB_B", "acc_B", "quat_WB"):
            np.testing.assert_array_equal(getattr(state, name), getattr(told[tick], name).astype(np.float32))
        np.testing.assert_allclose(state.tau, told[tick].tau, atol=1 / 256)


def test_half_of_the_packets_are_enough():
    lossy = Wire(latency_s=0.0, jitter_s=0.0, loss=0.3)
    with talk(commands=lossy, states=lossy) as (driver, emulation, asked, told):
        read = exchange(driver)
        found = driver.statistics
    every_command_is_the_law_or_damps(asked.laws)
    every_reading_is_what_was_measured(read, told.states)
    assert 20 < found.states < 0.7 * found.commands and found.checksum_errors == found.refused == 0
    assert len(asked.laws) == emulation.robot.commands and emulation.robot.refused == 0


@pytest.mark.parametrize("bits", [1, 2, 30])
def test_no_damaged_packet_changes_a_command_or_a_reading(bits):
    damaging = Wire(latency_s=0.0, jitter_s=0.0, corrupt=0.4, corrupt_bits=bits)
    with talk(commands=damaging, states=damaging) as (driver, emulation, asked, told):
        read = exchange(driver)
        found = driver.statistics
    every_command_is_the_law_or_damps(asked.laws)
    every_reading_is_what_was_measured(read, told.states)
    assert emulation.robot.refused > 10 and found.checksum_errors > 10 and "checksum" in driver.trouble


def test_duplicates_are_counted_and_read_once():
    doubling = Wire(latency_s=0.0, jitter_s=0.0, duplicate=1.0)
    with talk(states=doubling) as (driver, _, _, told):
        read = exchange(driver)
        found = driver.statistics
    every_reading_is_what_was_measured(read, told.states)
    assert found.duplicates >= found.states - 1 > 10 and found.old == 0 and found.trouble == ""


def test_a_command_that_comes_twice_is_the_same_command():
    with talk(commands=Wire(latency_s=0.0, jitter_s=0.0, duplicate=1.0)) as (driver, emulation, asked, told):
        read = exchange(driver)
    every_command_is_the_law_or_damps(asked.laws)
    every_reading_is_what_was_measured(read, told.states)
    assert emulation.robot.commands == len(asked.laws) > 20 and len(asked.laws) % 2 == 0


def test_what_is_overtaken_is_dropped_and_time_never_goes_back():
    shuffling = Wire(latency_s=0.0, jitter_s=0.0, reorder=0.3, reorder_s=0.007)
    with talk(states=shuffling) as (driver, _, _, told):
        read = exchange(driver)
        found = driver.statistics
    every_reading_is_what_was_measured(read, told.states)
    assert list(read) == sorted(read) and found.old > 10 and found.states > 10


@pytest.mark.parametrize(
    ("kind", "said"),
    [("stuck tick", r"[1-9]\d* repeats.*its tick moving"), ("silent", r"limit 200 ms \(\d+ states.*is it on")],
)
def test_a_robot_that_falls_silent_or_whose_tick_stands_is_a_fault(kind, said):
    with talk(faults=(Fault(kind, begin_s=0.1),), stale_s=0.2) as (driver, emulation, asked, _):
        with pytest.raises(HardwareFault, match=said):
            exchange(driver, commands=10**6)
        end = monotonic() + PATIENCE_S
        while not same_law(asked.laws[-1], damping_law(3.0)):  # what was sent before may still be on its way
            assert monotonic() < end, "the robot is driven on"
            driver.advance()
        heard = len(asked.laws)
        while len(asked.laws) < heard + 5:
            driver.advance()
    assert emulation.robot.t >= 0.1 and all(same_law(law, damping_law(3.0)) for law in asked.laws[heard:])
