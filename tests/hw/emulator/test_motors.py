"""Motors follow the law of the last command, and what they do when they cannot is a setting."""

from dataclasses import replace

import numpy as np
import pytest
from packet_samples import GOOD_LAW, ROBOT

from surefoot.config.emulator import Fault
from surefoot.config.emulator import Motors as Settings
from surefoot.config.robot import JOINT_NAMES
from surefoot.hw.aliengo.command_packet import BRAKE, SERVO, AliengoCommand
from surefoot.hw.emulator.broken_parts import BrokenParts
from surefoot.hw.emulator.motors import OVERHEATED, Motors

NONE = np.full(12, False)
LAW = replace(GOOD_LAW, tau=np.arange(12.0))


def motors(law=LAW, braked=NONE, faults=(), **settings):
    twelve = Motors(ROBOT, Settings(**settings), BrokenParts(faults))
    twelve.command(AliengoCommand(law, braked), 1.0)
    return twelve


def brakes(law, which=~NONE):
    """Whether the named joints, and no others, are in brake mode."""
    found = (law.kp == 0.0) & (law.tau == 0.0) & (law.dq == 0.0) & (law.kd == 20.0)
    return (found == which).all()


def test_they_brake_until_the_first_command():
    twelve = Motors(ROBOT, Settings(), BrokenParts(()))
    assert brakes(twelve.law(0.0)) and brakes(twelve.law(100.0)) and (twelve.mode == BRAKE).all()


def test_they_follow_the_law_of_the_last_command():
    twelve = motors()
    law = twelve.law(1.0)
    for name in ("q", "dq", "kp", "kd", "tau"):
        np.testing.assert_array_equal(getattr(law, name), getattr(LAW, name))
    assert (twelve.mode == SERVO).all()


def test_brake_mode_is_a_matter_of_each_motor():
    some = np.arange(12) % 3 == 0
    twelve = motors(braked=some)
    assert brakes(twelve.law(1.0), some)
    assert (twelve.mode == np.where(some, BRAKE, SERVO)).all()


def test_without_commands_they_hold_the_last_one_or_brake():
    assert not brakes(motors(on_silence="hold").law(60.0))
    assert brakes(motors(on_silence="hold").law(60.0), NONE)
    silent = motors(on_silence="brake", silence_s=0.010)
    assert brakes(silent.law(1.009), NONE) and brakes(silent.law(1.011))
    silent.command(AliengoCommand(LAW, NONE), 2.0)
    assert brakes(silent.law(2.0), NONE)


def test_commands_are_clamped_where_the_settings_say_so():
    beyond = replace(LAW, q=np.full(12, -3.0), tau=np.linspace(-100.0, 100.0, 12))
    as_it_comes = motors(beyond).law(1.0)
    np.testing.assert_array_equal(as_it_comes.q, beyond.q)
    np.testing.assert_array_equal(as_it_comes.tau, beyond.tau)
    clamped = motors(beyond, clamp_angles=True, clamp_torque=30.0).law(1.0)
    np.testing.assert_array_equal(clamped.q, np.array(ROBOT.position_range())[:, 0])
    np.testing.assert_array_equal(clamped.tau, np.clip(beyond.tau, -30.0, 30.0))


@pytest.mark.parametrize("braked", [NONE, ~NONE])
def test_a_dead_motor_does_nothing_while_it_is_dead_and_nobody_else_notices(braked):
    twelve = motors(braked=braked, faults=[Fault("dead motor", "RL_thigh", begin_s=2.0, end_s=3.0)])
    joint = JOINT_NAMES.index("RL_thigh")
    for t, dead in ((1.9, False), (2.0, True), (2.9, True), (3.0, False)):
        law = twelve.law(t)
        gone = np.array([law.kp, law.kd, law.tau]) == 0.0
        assert gone.all(axis=0)[joint] == dead and not gone.all(axis=0)[np.arange(12) != joint].any()


def test_a_steady_torque_heats_a_motor_to_its_end_and_rest_cools_it():
    twelve = motors(heating=0.05, heating_s=10.0, ambient=20.0)
    tau = np.where(np.arange(12) == 4, -30.0, 0.0)
    twelve.warm(tau, 10.0, 0.0)
    assert twelve.temperature[4] == pytest.approx(20.0 + 45.0 * (1.0 - np.exp(-1.0)))
    twelve.warm(tau, 1e4, 0.0)
    np.testing.assert_allclose(twelve.temperature, np.where(np.arange(12) == 4, 65.0, 20.0))
    twelve.warm(np.zeros(12), 1e4, 0.0)
    np.testing.assert_allclose(twelve.temperature, 20.0)


def test_a_motor_that_is_too_hot_brakes_and_says_so_until_it_has_cooled():
    twelve = motors(heating=1.0, heating_s=10.0, ambient=20.0, cooled=60.0, overheated=90.0)
    hot = np.arange(12) == 4
    twelve.warm(np.where(hot, 10.0, 0.0), 100.0, 0.0)
    assert brakes(twelve.law(1.0), hot) and (twelve.mode == np.where(hot, OVERHEATED, SERVO)).all()
    while twelve.temperature[4] > 60.0:
        assert brakes(twelve.law(1.0), hot)
        twelve.warm(np.zeros(12), 1.0, 0.0)
    assert brakes(twelve.law(1.0), NONE) and (twelve.mode == SERVO).all()


def test_a_motor_that_is_broken_hot_is_so_at_once_and_cools_when_it_is_right_again():
    twelve = motors(faults=[Fault("hot motor", "FL_hip", begin_s=2.0, end_s=3.0)], overheated=90.0, heating_s=10.0)
    for t, degrees in ((1.9, 25.0), (2.0, 91.0), (2.9, 91.0)):
        twelve.warm(np.zeros(12), 0.1, t)
        assert twelve.temperature[JOINT_NAMES.index("FL_hip")] == pytest.approx(degrees)
    assert brakes(twelve.law(2.9), np.arange(12) == JOINT_NAMES.index("FL_hip"))
    twelve.warm(np.zeros(12), 10.0, 3.0)
    assert twelve.temperature.max() < 60.0
