"""The status fits one screen and says what matters."""

import io

import numpy as np
import pytest
from rich.console import Console

from surefoot.bus.messages import FsmEvent, MotionReference, ProcessStatus, StateEstimate
from surefoot.bus.topics import PROCESSES
from surefoot.components.robot_model import LegKinematics
from surefoot.config.robot import load_robot
from surefoot.tools.picture import Picture, SupportMargin
from surefoot.tools.status_screen import screen


def standing():
    robot = load_robot("aliengo")
    q = np.tile(robot.nominal.stand_q, 4)
    height = np.array([0.0, 0.0, robot.nominal.leg_height])
    feet = height + LegKinematics(robot).position(q.reshape(4, 3))
    force = np.zeros((4, 3))
    force[1, 2] = 83.0
    up = np.array([0.0, 0.0, 1.0])
    quat = np.array([1.0, 0.0, 0.0, 0.0])
    return robot, StateEstimate(p_WB=height, quat_WB=quat, q=q, p_WF=feet, force_W=force, normal_W=up)


def full_picture():
    robot, estimate = standing()
    probe = np.zeros((7, 3))
    probe[:, 2] = [10.0, 60.0, 70.0, 80.0, 90.0, 100.0, 105.0]
    picture = Picture(estimate=estimate)
    picture.reference = MotionReference(
        t=12.5, state="PROBE", reason="why not", leg=1, candidate=2, around=3, force_index=2,
        normal_W=estimate.normal_W, probe_force_W=probe, p_WF=estimate.p_WF,
    )  # fmt: skip
    picture.margin_m = SupportMargin(robot)(estimate, picture.reference)
    for name, watched in picture.processes.items():
        watched.status = ProcessStatus(
            process=name, life="RUN", reason="late for tea", rate_hz=99.0, nominal_hz=50.0
        )
        watched.heard = 1e12
    for _ in range(40):
        picture.note_event(FsmEvent(t=1.0, kind="accepted", leg=2, reason="it held", displacement_m=0.004))
    picture.notes += ["mpc ended with signal 9, see log/mpc.log; restarted, 1 of 3"] * 9
    return picture


def shown(picture, width=100):
    out = io.StringIO()
    Console(file=out, width=width, height=40).print(screen(picture, 5, "T", "it stopped. go on"))
    return out.getvalue()


@pytest.mark.parametrize("width", [80, 100, 160])
def test_everything_is_on_one_screen(width):
    text = shown(full_picture(), width)
    assert len(text.splitlines()) <= 30
    for words in (
        "PROBE", "why not", "FR", "alternative 2 of 5", "point 3 of 4", "asked  80 N, measured  83 N",
        "force 3 of 6", "support margin", "12.5 s", "real-time factor", "footholds accepted 40",
        "displacement 4", "99/50", "late for tea", "restarted, 1 of 3", "it stopped. go on", "it held",
    ):  # fmt: skip
        assert words in text, words
    assert all(name in text for name in PROCESSES)


def test_the_first_picture_says_what_is_awaited():
    picture = Picture()
    assert "the processes come up" in shown(picture) and "Why nothing moves: no process" in shown(picture)
    picture.note_status(ProcessStatus(process="io", life="IDLE", reason="waiting for mpc to come up"))
    text = shown(picture)
    assert "mpc: has not spoken yet" in text and "and 4 more" in text
    assert "Why nothing moves: simulated time waits for mpc, which has not spoken" in text
    reason = "simulated time waits for mpc, 1.5 s now"
    picture.note_status(ProcessStatus(process="io", t=30.8, steps=15400, reason=reason))
    assert "time stands at 30.80 s" in shown(picture)


@pytest.mark.parametrize("width", [80, 120])
def test_a_row_holds_all_that_is_known_of_a_process(width):
    picture = full_picture()
    picture.note_status(
        ProcessStatus(
            process="wbc", life="RUN", rate_hz=249.6, nominal_hz=250.0, step_p50_ms=0.834, step_p99_ms=12.34,
            step_max_ms=1234.5, overruns=1234, bad_messages=56, boot=12, reason="late for tea",
            input=("state/estimate", "fsm/reference"), input_age_s=np.array([0.0312, 0.004]),
        )
    )  # fmt: skip
    for name in ("mpc", "fsm"):
        picture.note_status(ProcessStatus(process=name, life="RUN"))
    picture.processes["mpc"].lent_to = 4194303
    picture.processes["trajopt"].out = "ended with exit code 1 (NameError: x), see log/trajopt.log"
    text = shown(picture, width)
    rows = {line.split()[0]: line.split()[1:] for line in text.splitlines() if line.split()}
    figures = ["250/250", "0.83", "12.3", "1234", "1234", "56", "state/estimate", "31/40", "12"]
    assert rows["wbc"] == ["RUN", *figures]
    assert rows["mpc"][0] == "lent" and rows["trajopt"][0] == "out"
    assert "trajopt: ended with exit code 1 (NameError: x)" in text
    assert "Why nothing moves: trajopt ended with exit code 1" in text
    assert len(text.splitlines()) <= 30 and all(len(line) <= width for line in text.splitlines())


def test_one_that_is_lent_is_told_with_the_process_that_has_it():
    picture = full_picture()
    for name, watched in picture.processes.items():
        picture.note_status(ProcessStatus(process=name, life="RUN"))
        assert watched.status.reason == ""
    picture.processes["mpc"].lent_to = 4194303
    assert "mpc: lent to process 4194303" in shown(picture)


def test_one_that_is_late_stands_out():
    picture = full_picture()
    late = {"input": ("mpc/policy",), "input_age_s": np.array([0.25])}
    picture.note_status(ProcessStatus(process="wbc", life="RUN", nominal_hz=250.0, **late))
    text = shown(picture)
    assert "mpc/policy 250/100" in text and "mpc is late" in text


def test_the_margin_is_that_of_the_other_three_feet():
    robot, estimate = standing()
    margin = SupportMargin(robot)
    reference = MotionReference(leg=-1, p_WF=estimate.p_WF)
    assert margin(estimate, reference) is None
    values = [margin(estimate, MotionReference(leg=leg, p_WF=estimate.p_WF)) for leg in range(4)]
    # Standing in the middle, the centre of mass is within two centimetres of every diagonal.
    assert all(abs(value) < 0.02 for value in values)
    far = estimate.p_WF + [1.0, 0.0, 0.0]
    assert margin(estimate, MotionReference(leg=0, p_WF=far)) < -0.5
