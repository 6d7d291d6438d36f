"""What a robot at rest tells of itself, made up."""

from dataclasses import replace

import numpy as np
import pytest
from packet_samples import ROBOT, drawn_state

from surefoot.config.doctor import Doctor
from surefoot.hw.aliengo.command_packet import SERVO
from surefoot.tools.doctor.check import Level
from surefoot.tools.doctor.robot_state import check_state, tilt_of

LIES = replace(
    drawn_state(np.random.default_rng(3)),
    q=np.tile(ROBOT.nominal.lie_q, 4),
    acc_B=np.array([0.1, 0.0, 9.8]),
    omega_WB_B=np.full(3, 0.01),
    temperature=np.full(12, 30.0),
    mode=np.full(12, SERVO, np.uint8),
    foot_force=np.array([3.0, -2.0, 0.0, 7.0]),
)
REMOTE = np.arange(40, dtype=np.uint8)


def found(remote=REMOTE, **change):
    return {finding.check: finding for finding in check_state([replace(LIES, **change)], remote, ROBOT, Doctor())}


def put(values, index, value):
    changed = np.array(values)
    changed[index] = value
    return changed


def test_a_robot_that_lies_is_well():
    levels = {check: finding.level for check, finding in found(foot_force=np.ones(4)).items()}
    assert set(levels.values()) == {Level.OK} and len(levels) == 8


def test_a_leg_against_its_stop_is_well():
    assert found(q=put(LIES.q, 2, -2.80))["joint angles"].level is Level.OK


@pytest.mark.parametrize(
    ("change", "check", "level", "words"),
    [
        ({"q": put(LIES.q, 4, 4.2)}, "joint angles", Level.FAIL, "FR_thigh at 4.20 rad"),
        ({"acc_B": np.array([0.0, 0.0, -9.8])}, "accelerometer", Level.FAIL, "z -9.80"),
        ({"acc_B": np.array([0.0, 0.0, 1.0])}, "accelerometer", Level.FAIL, "1.00 m/s^2"),
        ({"acc_B": np.array([5.0, 0.0, 8.4])}, "level", Level.FAIL, "tilted by 0.54 rad"),
        ({"omega_WB_B": np.array([0.0, 0.4, 0.0])}, "gyroscope", Level.WARN, "0.400 rad/s"),
        ({"temperature": put(LIES.temperature, 7, 60.0)}, "motors", Level.WARN, "RL_thigh 60 deg C"),
        ({"temperature": put(LIES.temperature, 7, 90.0)}, "motors", Level.FAIL, "RL_thigh 90 deg C"),
        ({"mode": put(LIES.mode, 11, 8)}, "motor modes", Level.FAIL, "RR_calf 08"),
        ({"foot_force": np.array([3.0, -2.0, 0.0, 7.0])}, "foot sensors", Level.WARN, "RL tell nothing"),
        ({"remote": np.zeros(40, np.uint8)}, "remote", Level.WARN, "nothing comes"),
    ],
)
def test_what_is_amiss_is_told_with_what_to_do(change, check, level, words):
    finding = found(**change)[check]
    assert finding.level is level and words in finding.found and finding.remedy


def test_a_tilt_is_told_of_any_specific_force():
    assert tilt_of(np.array([0.0, 0.0, 3.0])) == 0.0
    assert tilt_of(np.array([2.0, 0.0, 2.0])) == pytest.approx(np.pi / 4)
    assert tilt_of(np.zeros(3)) == tilt_of(np.array([0.0, 0.0, -1.0])) == pytest.approx(np.pi)
