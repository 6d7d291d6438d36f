"""The driver whose robot waits: a cycle of the caller is a cycle of the robot, whatever road and link do."""

from contextlib import contextmanager
from dataclasses import replace

import numpy as np
import pytest
from emulation import emulator
from lossy_road import lossy_road
from machines import LEGS_UP, deployment, raise_legs

from surefoot.config.emulator import Fault, Wire
from surefoot.hw.aliengo.backend import open_aliengo
from surefoot.hw.errors import HardwareFault
from surefoot.hw.robot_interface import MotorLaw

LAW = MotorLaw(q=LEGS_UP, dq=np.zeros(12), kp=np.full(12, 100.0), kd=np.full(12, 3.0), tau=np.zeros(12))
SOUND = Wire(latency_s=0.0, jitter_s=0.0)
CYCLES = 120


@contextmanager
def lockstep(fate=None, **link):
    """The driver and the emulation, with a road between them that treats datagrams by `fate`."""
    with emulator(deployment("cycle", tick_unit="us", **link), raise_legs) as there:
        if fate is None:
            driver = open_aliengo(there.deployment)
            yield driver, there
            driver.close()
            return
        with lossy_road(there.server.port, fate) as road:
            hw = there.deployment.hw
            detour = replace(hw, aliengo=replace(hw.aliengo, port=road.port))
            driver = open_aliengo(replace(there.deployment, hw=detour))
            yield driver, there
            driver.close()


def walk(driver, cycles=CYCLES):
    """(ticks, angles) that are read in so many cycles."""
    read = []
    for n in range(cycles):
        driver.write(replace(LAW, tau=np.full(12, 2.0 * np.sin(0.3 * n))))
        driver.advance()
        read.append((driver.newest.state.tick, driver.read().q.tobytes()))
    return read


@pytest.fixture(scope="module")
def undisturbed():
    with lockstep() as (driver, _):
        return walk(driver)


@pytest.mark.parametrize(
    "fate",
    [
        pytest.param(lambda n: 0 if n % 11 == 0 else 1, id="one in eleven is lost"),
        pytest.param(lambda n: 2, id="all come twice"),
        pytest.param(lambda n: "late" if n % 7 == 0 else 1, id="answers come after the question was asked again"),
    ],
)
def test_what_gets_lost_on_the_road_costs_nothing_but_the_wait(fate, undisturbed):
    with lockstep(fate) as (driver, there):
        assert walk(driver) == undisturbed
        assert there.robot.t == pytest.approx(0.002 * (CYCLES + 1))
        assert there.robot.commands == CYCLES + 1 and driver.statistics.states == CYCLES + 1


def test_what_the_link_loses_is_missing_and_the_newest_state_grows_older_by_whole_cycles():
    lossy = replace(SOUND, loss=0.2)
    with lockstep(commands=lossy, states=lossy) as (driver, there):
        ages = set()
        for _ in range(CYCLES):
            driver.write(LAW)
            driver.advance()
            age = driver.read().age_s
            assert age == pytest.approx(there.robot.t - 1e-6 * driver.newest.state.tick, abs=1e-9)
            ages.add(round(age / 0.002))
        found = driver.statistics
    assert {0, 1, 2} <= ages <= set(range(12))
    assert there.robot.t > 0.002 * CYCLES and 0.25 < found.loss < 0.5 and found.trouble == ""


def test_what_the_link_damages_is_refused_and_what_it_doubles_or_overtakes_is_counted():
    bad = replace(SOUND, corrupt=0.2, duplicate=0.2, reorder=0.2, reorder_s=0.004)
    with lockstep(commands=bad, states=bad) as (driver, there):
        ticks = [tick for tick, _ in walk(driver)]
        found = driver.statistics
    assert ticks == sorted(ticks) and there.robot.refused > 5
    assert min(found.duplicates, found.old, found.checksum_errors) > 5 and "checksum" in driver.trouble


def test_of_a_delay_only_what_differs_from_the_quickest_shows():
    jittery = Wire(latency_s=0.004, jitter_s=0.005)
    with lockstep(states=jittery) as (driver, there):
        walk(driver, 50)
        told, true = [], []
        for _ in range(CYCLES):
            driver.advance()
            told.append(driver.read().age_s)
            true.append(there.robot.t - 1e-6 * driver.newest.state.tick)
    late = np.array(true) - np.array(told)
    np.testing.assert_allclose(late, late[0], atol=1e-9)
    assert min(told) == 0.0 < max(told) and late[0] == pytest.approx(min(true))


@pytest.mark.parametrize("fault", [Fault("silent", begin_s=0.1), Fault("stuck tick", begin_s=0.1)])
def test_silence_is_a_fault_once_the_newest_state_is_too_old_by_simulated_time(fault):
    with lockstep(faults=(fault,), stale_s=0.050) as (driver, there):
        with pytest.raises(HardwareFault, match=r"is 52 ms old by its tick, limit 50 ms"):
            walk(driver, 1000)
        assert there.robot.t == pytest.approx(0.098 + 0.052)


def test_a_robot_that_never_speaks_is_waited_for_in_its_own_time():
    dumb = deployment("cycle", faults=(Fault("silent"),), first_answer_s=0.4)
    said = r"has sent no good state in 0\.4 s and 200 commands"
    with emulator(dumb) as there, pytest.raises(HardwareFault, match=said):
        open_aliengo(there.deployment)


def test_an_emulator_that_follows_the_wall_is_named():
    waits = deployment("cycle", first_answer_s=0.3)
    at_its_own_pace = replace(waits, emulator=replace(waits.emulator, pace="wall"))
    with emulator(at_its_own_pace) as there, pytest.raises(HardwareFault, match=r"emulator\.pace = packets"):
        open_aliengo(there.deployment)


def test_closing_damps_on_the_worst_of_links():
    bad = Wire(latency_s=0.010, jitter_s=0.010, loss=0.3)
    with lockstep(commands=bad) as (driver, there):
        walk(driver, 30)
        driver.close()
        law = there.robot._motors.law(there.robot.t)
    assert not law.kp.any() and not law.tau.any() and (law.kd == 3.0).all()
