"""What speaks against moving a robot, in pictures of made-up runs."""

from dataclasses import replace

import numpy as np
import pytest

from surefoot.bus.messages import HardwareState, MotionReference, ProcessStatus, StateEstimate
from surefoot.config.doctor import Doctor
from surefoot.config.robot import load_robot
from surefoot.tools.picture import Picture
from surefoot.tools.startup.readiness import Readiness

ROBOT = load_robot("aliengo")
LIES = HardwareState(
    t=1.0, valid=True, q=np.tile(ROBOT.nominal.lie_q, 4), acc_B=np.array([0.0, 0.0, 9.8]), damping=False
)


def picture(**hardware):
    made = Picture(hardware=replace(LIES, **hardware), estimate=StateEstimate(), reference=MotionReference())
    for name in made.processes:
        made.note_status(ProcessStatus(process=name, life="RUN"))
    return made


def refusal(picture, lies=True):
    readiness = Readiness(ROBOT, Doctor())
    readiness.look(picture)
    return readiness.refusal(picture, lies)


def awaited(picture):
    return Readiness(ROBOT, Doctor()).awaited(picture)


def turned(joint, angle):
    q = LIES.q.copy()
    q[joint] += angle
    return q


def test_a_robot_that_lies_folded_and_level_is_ready():
    assert awaited(picture()) == refusal(picture()) == ""


def test_in_the_air_its_legs_may_be_anywhere():
    assert refusal(picture(q=turned(2, 1.2)), lies=False) == ""


@pytest.mark.parametrize(
    ("hardware", "words"),
    [
        ({"acc_B": np.array([0.0, 5.5, 8.1])}, "level: tilted by 0.60 rad"),
        ({"acc_B": np.array([0.0, 0.0, -9.8])}, "level: tilted by 3.14 rad"),
        ({"omega_WB_B": np.array([0.5, 0.0, 0.0])}, "gyroscope: 0.500 rad/s"),
        ({"q": turned(1, 4.0)}, "joint angles: FL_thigh at 5.25 rad"),
        ({"q": turned(5, 1.2)}, "FR_calf is 1.20 rad from where it lies, limit 0.6 rad"),
        ({"damping": True, "gate": "a motor is too hot"}, "the gate in io damps: a motor is too hot"),
    ],
)
def test_what_speaks_against_it_is_told(hardware, words):
    assert words in refusal(picture(**hardware))


def test_who_is_not_there_is_awaited_and_who_has_failed_is_named():
    made = picture()
    made.processes["mpc"].status = None
    assert awaited(made) == "mpc to come up" and "mpc" in refusal(made)
    made = picture()
    made.hardware = None
    assert awaited(made) == "io to tell hw/state"
    made = picture()
    made.note_status(ProcessStatus(process="wbc", life="FAILED", reason="a bug"))
    assert refusal(made) == "wbc has failed: a bug"


def test_one_that_trembles_is_judged_by_its_median():
    readiness = Readiness(ROBOT, Doctor())
    for n in range(10):
        made = picture(acc_B=np.array([9.0 * (n == 7), 0.0, 9.8]))
        made.hardware = replace(made.hardware, t=0.1 * n)
        readiness.look(made)
    assert readiness.refusal(made, lies=True) == ""
