"""The driver speaks in every cycle, damps whenever nobody asks for more, and never passes on what is old.

A robot on 127.0.0.1 answers over real sockets. Counts and contents are judged, never how long something took.
"""

import os
import subprocess
import sys
import threading
from contextlib import contextmanager
from dataclasses import replace

import numpy as np
import pytest
from packet_samples import GOOD_LAW, ROBOT
from udp_robot import UdpRobot, damps, one_state

from surefoot.config.aliengo import Aliengo
from surefoot.hw.aliengo.driver import AliengoDriver
from surefoot.hw.aliengo.generation import G0, G1
from surefoot.hw.errors import HardwareFault, PacketError

UNHURRIED = {"law_timeout_s": 1.0, "stale_s": 1.0, "first_answer_s": 60.0, "local_port": 0, "tick_unit": "none"}


@contextmanager
def driver_of(robot, **settings):
    chosen = (
        UNHURRIED | {"address": "127.0.0.1", "port": robot.port, "generation": robot.generation.name} | settings
    )
    driver = AliengoDriver(ROBOT, Aliengo(**chosen), damping_kd=3.0)
    try:
        yield driver
    finally:
        driver.close()


def follows_the_law(command):
    return not command.braked.any() and (command.law.kp == 20.0).all() and (command.law.kd == 2.0).all()


@pytest.mark.parametrize("generation", [G0, G1], ids=lambda generation: generation.name)
def test_sensors_come_in_and_motor_laws_go_out_in_our_order(generation):
    with UdpRobot(generation) as robot, driver_of(robot) as driver:
        sensors = driver.read()
        for name in ("q", "dq", "tau", "omega_WB_B", "acc_B"):
            np.testing.assert_allclose(getattr(sensors, name), getattr(robot.state, name), atol=1 / 256)
        assert driver.newest.state.remote == robot.state.remote
        assert driver.depth() is None and driver.truth() is None
        law = replace(GOOD_LAW, tau=np.arange(12.0))
        driver.write(law)
        heard = robot.hears(follows_the_law).law
        np.testing.assert_array_equal(heard.tau, law.tau)
        np.testing.assert_allclose(heard.q, law.q, atol=1e-6)


def test_it_damps_from_the_first_command_on():
    with UdpRobot() as robot, driver_of(robot):
        assert all(damps(command) for command in robot.hears_more(5) + robot.commands[:1])


def test_a_law_is_sent_until_the_next_and_a_cycle_without_one_damps():
    with UdpRobot() as robot, driver_of(robot) as driver:
        driver.write(GOOD_LAW)
        driver.advance()
        robot.hears(follows_the_law)
        driver.write(replace(GOOD_LAW, tau=np.ones(12)))
        driver.advance()
        robot.hears(lambda command: follows_the_law(command) and (command.law.tau == 1.0).all())
        driver.advance()
        assert damps(robot.hears_next_of(driver))
        assert all(damps(command) for command in robot.hears_more(5))


def test_a_law_that_grows_old_is_sent_no_more():
    with UdpRobot() as robot, driver_of(robot, law_timeout_s=0.05) as driver:
        while not follows_the_law(robot.commands[-1]):
            driver.write(GOOD_LAW)
            robot.hears_more(1)
        robot.hears(damps)
        assert all(damps(command) for command in robot.hears_more(5))


def test_damping_may_be_the_motors_brake():
    with UdpRobot() as robot, driver_of(robot, damping="brake"):
        assert all(command.braked.all() for command in robot.hears_more(3))


def test_a_law_that_no_robot_could_follow_damps_and_is_named():
    with UdpRobot() as robot, driver_of(robot) as driver:
        driver.write(GOOD_LAW)
        robot.hears(follows_the_law)
        with pytest.raises(PacketError, match=r"law\.q of FL_hip = nan"):
            driver.write(replace(GOOD_LAW, q=np.full(12, np.nan)))
        assert damps(robot.hears_next_of(driver))


def test_what_of_a_law_does_not_fit_is_said():
    with UdpRobot() as robot, driver_of(robot) as driver:
        driver.write(replace(GOOD_LAW, tau=np.full(12, 130.0)))
        assert driver.trouble.count("does not fit") == 12 and "law.tau of FR_hip = 130" in driver.trouble
        robot.hears(lambda command: (command.law.tau == 32767 / 256).all())
        driver.write(GOOD_LAW)
        assert driver.trouble == ""


def test_what_the_robot_tells_next_is_read_next():
    with UdpRobot() as robot, driver_of(robot) as driver:
        robot.state = replace(robot.state, dq=np.full(12, 5.0))
        while not (driver.read().dq == 5.0).all():
            robot.hears_more(1)


def test_repeats_old_ticks_and_damage_are_counted_and_dropped():
    def much(robot):
        first = one_state(robot)[0]
        robot.tick -= 1
        late = robot.packet()
        robot.tick += 1
        return [first, first, late, first[:-1] + bytes([first[-1] ^ 1]), first[:700], bytes(684)]

    with UdpRobot(answer=much) as robot, driver_of(robot) as driver:
        robot.hears_more(20)
        assert driver.newest.state.tick % 2000 == 0
    found = driver.statistics
    assert found.states >= 5 and found.trouble
    for count in (found.duplicates, found.old, found.checksum_errors, found.refused / 2):
        assert found.states - 1 <= count <= found.states


def test_the_statistics_tell_how_many_commands_were_answered():
    def every_second(robot):
        return one_state(robot) if len(robot.commands) % 2 else []

    with UdpRobot(answer=every_second) as robot, driver_of(robot) as driver:
        robot.hears_more(40)
        driver.read()
    found = driver.statistics
    assert found.commands >= 40 and 0 < found.states <= (len(robot.commands) + 1) // 2
    assert 0.4 <= found.loss < 1.0 and found.rate_hz > 0.0
    assert 0.0 < found.latency_ms <= found.latency_max_ms and found.trouble == ""


def test_a_robot_that_falls_silent_is_a_fault():
    with UdpRobot() as robot, driver_of(robot, stale_s=0.05) as driver:
        robot.answer = lambda robot: []
        with pytest.raises(
            HardwareFault, match=r"the newest state of 127\.0\.0\.1:\d+ is \d+ ms old .*limit 50 ms"
        ):
            while True:
                driver.read()


def test_a_robot_whose_tick_stands_still_is_a_fault():
    with UdpRobot() as robot, driver_of(robot, stale_s=0.05) as driver:
        robot.answer = lambda robot: [robot.packet()]
        with pytest.raises(HardwareFault, match=r"[1-9]\d* repeats, 0 old ticks.*its tick moving"):
            while True:
                driver.read()


def test_a_robot_that_restarts_is_a_fault():
    with UdpRobot() as robot, driver_of(robot, stale_s=0.05) as driver:
        robot.hears_more(5)
        robot.tick -= 10**6
        with pytest.raises(HardwareFault, match=r"[1-9]\d* old ticks"):
            while True:
                driver.read()


def test_a_silent_robot_is_waited_for_damped_and_named():
    with UdpRobot(answer=lambda robot: []) as robot:
        with pytest.raises(HardwareFault, match=r"no good state in 0\.05 s and \d+ commands \(0 states"):
            AliengoDriver(
                ROBOT, Aliengo(address="127.0.0.1", port=robot.port, local_port=0, first_answer_s=0.05), 3.0
            )
        robot.hears(damps)
        assert all(damps(command) for command in robot.commands)


def test_a_robot_of_the_other_generation_is_named():
    def as_g0(robot):
        return [bytes(684)]

    with UdpRobot(answer=as_g0) as robot, pytest.raises(HardwareFault, match=r"set hw\.aliengo\.generation = G0"):
        AliengoDriver(ROBOT, Aliengo(address="127.0.0.1", port=robot.port, local_port=0, first_answer_s=1.0), 3.0)


def test_closing_damps_and_ends_the_thread():
    with UdpRobot() as robot:
        with driver_of(robot) as driver:
            driver.write(GOOD_LAW)
            robot.hears(follows_the_law)
        last = driver.statistics.commands
        robot.hears(lambda command: len(robot.commands) > last)
        robot.hears(damps)
        driver.close()
        driver.write(GOOD_LAW)
        assert not [thread for thread in threading.enumerate() if thread.name == "aliengo"]
        assert driver.statistics.commands == last and damps(robot.commands[-1])


DIES = """
from surefoot.config.aliengo import Aliengo
from surefoot.hw.aliengo.driver import AliengoDriver
from packet_samples import GOOD_LAW, ROBOT

settings = Aliengo(address="127.0.0.1", port={port}, local_port=0, law_timeout_s=1.0, first_answer_s=60.0)
driver = AliengoDriver(ROBOT, settings, 3.0)
driver.write(GOOD_LAW)
begin = driver.statistics.commands
while driver.statistics.commands < begin + 2:
    pass
raise RuntimeError("on the way out")
"""


def test_a_program_that_dies_of_an_error_leaves_the_robot_damped():
    with UdpRobot() as robot:
        path = os.pathsep.join(sys.path)
        command = [sys.executable, "-P", "-c", DIES.format(port=robot.port)]
        ended = subprocess.run(command, env=os.environ | {"PYTHONPATH": path}, capture_output=True, text=True)
        assert ended.returncode == 1 and "on the way out" in ended.stderr
        robot.hears(damps)
    assert any(follows_the_law(command) for command in robot.commands) and damps(robot.commands[-1])
