"""`surefoot calibrate` as it is called: over a bus, or with a robot of its own; what it writes can be applied."""

import io as streams
import os
import threading
from contextlib import contextmanager

import numpy as np
import pytest
from stands import standing_states

from surefoot.bus.codec import encode
from surefoot.bus.session import Session
from surefoot.components.component import Inbox, Outbox
from surefoot.components.deployment_desk import serve_deployment
from surefoot.components.io.io import Io
from surefoot.config.deployment import Deployment
from surefoot.config.hw import Hw
from surefoot.config.unit import load_unit
from surefoot.hw.calibrated_robot import CalibratedRobot
from surefoot.hw.mujoco.plant import draw_plant
from surefoot.tools.cli import main

NAMESPACE = f"calibrate-{os.getpid()}"
SEED = 7


@contextmanager
def stack(deployment, states):
    """A bus on which io tells these states over and over."""
    hub, ended = Session(NAMESPACE, hub=True), threading.Event()
    serve_deployment(hub, deployment)
    payloads = [encode(state) for state in states]

    def tell():
        while not ended.wait(0.05):
            for payload in payloads:
                hub.put("hw/state", payload)

    thread = threading.Thread(target=tell, daemon=True)
    thread.start()
    try:
        yield
    finally:
        ended.set()
        thread.join()
        hub.close()


def calibrate(out, *options):
    return main(["calibrate", "flat", "--out", str(out), "--set", f"hw.seed={SEED}", *options])


def standing(out, *options):
    return calibrate(out, "--standing", "--namespace", NAMESPACE, "--set", "calibration.seconds=1", *options)


def test_standing_it_hears_a_stack_and_writes_a_file_that_io_applies(tmp_path, capsys):
    out, deployment = tmp_path / "unit.toml", Deployment(hw=Hw(seed=SEED))
    with stack(deployment, standing_states(Io(deployment), 1.2)):
        assert standing(out, "--level-floor") == 0
    said = capsys.readouterr().out
    assert "estimator.contact_on_n" in said and f"written to {out}" in said and "hang it up" in said
    unit, plant = load_unit(out, "aliengo"), draw_plant(deployment.load_robot(), deployment.hw)
    assert unit.parts == ("gyroscope", "accelerometer") and unit.gyroscope.measured.pose == "standing"
    np.testing.assert_allclose(unit.gyroscope.bias, plant.gyro_bias, atol=2e-3)
    io = Io(Deployment(hw=Hw(seed=SEED, unit=str(out))))
    assert isinstance(io.robot, CalibratedRobot)
    left = np.mean([state.omega_WB_B for state in standing_states(io, 1.0)], axis=0)
    assert np.abs(left).max() < 2e-3 < np.abs(plant.gyro_bias).max()


@pytest.mark.parametrize(
    ("running", "damping", "words"),
    [
        (Hw(unit="mine.toml"), False, "corrected by mine.toml already: run it with --set hw.unit="),
        (Hw(), True, "the robot damps (no command yet): surefoot command stand"),
    ],
)
def test_what_cannot_be_measured_is_said_and_nothing_is_written(tmp_path, capsys, running, damping, words):
    io = Io(Deployment())
    states = [] if not damping else _damped(io)
    with stack(Deployment(hw=running), states):
        assert standing(tmp_path / "unit.toml") == 1
    assert words in capsys.readouterr().err and not (tmp_path / "unit.toml").exists()


def _damped(io):
    told = []
    io.step(0.0, Inbox(io.inputs), Outbox(io.outputs, lambda key, message: told.append((key, message))))
    return [message for key, message in told if key == "hw/state"]


def test_hung_it_moves_only_with_a_yes_and_keeps_what_the_file_has(tmp_path, capsys, monkeypatch):
    out = tmp_path / "unit.toml"
    out.write_text(
        'robot = "aliengo"\n[foot_zero]\nraw = [1, 2, 3, 4]\n'
        '[foot_zero.measured]\ndate = "2026-01-31"\npose = "hung"\nseconds = 10\n'
    )
    monkeypatch.setattr("sys.stdin", streams.StringIO("yes\nno\n"))
    assert calibrate(out, "--hung", "--set", "hw.start=hung", "--set", "calibration.seconds=2") == 0
    said = capsys.readouterr().out
    assert "Now it MOVES" in said and "friction: not agreed to, left out" in said
    unit = load_unit(out, "aliengo")
    assert unit.parts == ("gyroscope", "accelerometer", "torque", "foot_zero")
    assert unit.foot_zero.raw == (1.0, 2.0, 3.0, 4.0) and unit.torque.measured.seconds == pytest.approx(
        2.0, abs=0.01
    )


def test_without_an_operator_nothing_is_done(tmp_path, capsys, monkeypatch):
    monkeypatch.setattr("sys.stdin", streams.StringIO(""))
    assert calibrate(tmp_path / "unit.toml", "--hung", "--set", "hw.start=hung") == 1
    assert "not agreed to: nothing was done" in capsys.readouterr().err
