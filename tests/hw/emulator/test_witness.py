"""What became of a robot is told from the truth alone."""

from dataclasses import replace

import numpy as np
import pytest

from surefoot.bus.messages import SimTruth
from surefoot.hw.emulator.witness import Witness
from surefoot.hw.robot_interface import damping_law

LIES = SimTruth(t=0.0, valid=True, p_WB=np.array([0.0, 0.0, 0.1]), quat_WB=np.eye(4)[0], body_contact="trunk")
DAMPED = damping_law(3.0)
DRIVEN = replace(DAMPED, kp=np.full(12, 100.0))
STANDS = replace(LIES, p_WB=np.array([0.1, 0.0, 0.4]), body_contact="")


def leaning(angle):
    return replace(STANDS, quat_WB=np.array([np.cos(angle / 2), np.sin(angle / 2), 0.0, 0.0]))


def witness(*truths, end_x=1.0):
    made = Witness(end_x)
    for n, truth in enumerate(truths):
        made.see(truth, DRIVEN, 0.5 * n)
    return made


def test_one_that_lies_has_neither_stood_nor_fallen():
    seen = witness(LIES, LIES)
    assert seen.stood_t is None and seen.fell == "" and "has not stood" in str(seen)


def test_how_far_it_went_and_how_much_it_tilted_since_it_stood():
    seen = witness(LIES, STANDS, leaning(0.2), replace(STANDS, p_WB=np.array([0.7, 0.0, 0.4])))
    assert seen.stood_t == 0.5 and seen.forward_m == pytest.approx(0.7) and seen.tilt == pytest.approx(0.2)
    assert str(seen) == "the robot stood at 0.5 s and went 0.70 m forward: upright, tilted by 0.20 rad at the most"


@pytest.mark.parametrize(
    ("truth", "said"),
    [
        (leaning(0.9), "tilted by 0.90 rad at 1.000 s"),
        (replace(STANDS, body_contact="FL_hip"), "touched the ground with FL_hip at 1.000 s"),
    ],
)
def test_a_fall_stays_a_fall(truth, said):
    assert witness(LIES, STANDS, truth, STANDS).fell == said


def test_one_that_is_damped_sinks_and_may_get_up_again():
    seen = Witness(1.0)
    sunk = replace(STANDS, body_contact="trunk FL_thigh")
    for n, (truth, law) in enumerate(((STANDS, DRIVEN), (sunk, DAMPED), (sunk, DRIVEN), (STANDS, DRIVEN))):
        seen.see(truth, law, float(n))
    assert seen.fell == ""
    seen.see(sunk, DRIVEN, 4.0)
    assert seen.fell == "touched the ground with trunk FL_thigh at 4.000 s"


def test_a_calf_that_brushes_an_edge_is_no_fall():
    assert witness(STANDS, replace(STANDS, body_contact="RL_calf")).fell == ""


def test_it_has_crossed_once_all_feet_were_past_the_end():
    feet = np.array([[1.5, 0, 0], [1.5, 0, 0], [0.9, 0, 0], [1.1, 0, 0]], float)
    assert not witness(replace(STANDS, p_WF=feet)).crossed
    assert witness(replace(STANDS, p_WF=feet + [0.2, 0, 0]), STANDS).crossed


def test_it_tells_since_when_no_motor_has_been_driven():
    seen, told = Witness(1.0), []
    for n, law in enumerate((DAMPED, DRIVEN, DAMPED, DAMPED, DRIVEN, DAMPED, DAMPED)):
        seen.see(STANDS, law, float(n))
        told.append(seen.damped_t)
    assert told == [0.0, None, 2.0, 2.0, None, 5.0, 5.0]
