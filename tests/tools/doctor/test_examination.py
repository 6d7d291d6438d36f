"""A whole examination, with the emulator over real sockets: only damping is sent, and what is wrong is named."""

import json
import os
import socket
from contextlib import contextmanager
from dataclasses import replace

import pytest
from emulation import PATIENT, emulator

from surefoot.bus.hub_socket import socket_path
from surefoot.config.aliengo import Aliengo
from surefoot.config.deployment import Deployment, Run
from surefoot.config.doctor import Doctor
from surefoot.config.emulator import Emulator, Fault, Wire
from surefoot.config.hw import Hw
from surefoot.tools.cli import main
from surefoot.tools.doctor.check import Level, failures
from surefoot.tools.doctor.examination import examine_robot
from surefoot.tools.doctor.report import as_json, as_lines


def deployment(states=None, faults=(), namespace="", **wire):
    return Deployment(
        run=Run(namespace=namespace or f"test-doctor-{os.getpid()}"),
        hw=Hw(backend="aliengo", start="lying", aliengo=Aliengo(exchange="cycle", **PATIENT | wire)),
        emulator=Emulator(pace="packets", states=states or Wire(), faults=faults),
        doctor=Doctor(watch_s=0.3),
    )


class Examined:
    """What was found in an emulated robot.

    Attributes:
        findings: by group; `said` before anything was sent; `laws` that the motors got.
    """

    def __init__(self, there, **changed):
        self.said, self.laws = [], []
        follow = there.robot._motors.command

        def command(command, t):
            self.laws.append(command.law)
            follow(command, t)

        there.robot._motors.command = command
        wire = replace(there.deployment.hw.aliengo, **changed)
        asked = replace(there.deployment, hw=replace(there.deployment.hw, aliengo=wire))
        self.findings = examine_robot(asked, self.said.append)

    def __getitem__(self, check):
        return next(finding for group in self.findings.values() for finding in group if finding.check == check)


@contextmanager
def examined(changed=None, prepare=lambda robot: None, **settings):
    with emulator(deployment(**settings)) as there:
        prepare(there.robot)
        yield Examined(there, **(changed or {}))


def test_a_sound_robot_passes_and_gets_zero_gains_then_damping():
    with examined() as seen:
        assert failures(seen.findings) == [] and list(seen.findings) == ["network", "link", "robot"]
    assert len(seen.said) == 1 and "zero gains" in seen.said[0]
    assert not any(law.kp.any() or law.tau.any() or law.dq.any() for law in seen.laws)
    assert not seen.laws[0].kd.any() and (seen.laws[-1].kd == 3.0).all()


def test_a_robot_of_the_other_generation_is_recognised_and_named():
    with examined({"generation": "G1", "first_answer_s": 10.0}, generation="G0") as seen:
        assert seen["generation"].level is Level.FAIL and seen["generation"].found == "G0, 684 bytes"
        assert seen["generation"].remedy == 'set hw.aliengo.generation = "G0"'


def test_silence_is_a_failure_with_what_to_do():
    with examined({"first_answer_s": 0.2}, faults=(Fault("silent"),)) as seen:
        assert seen["answer"].level is Level.FAIL and seen["answer"].found.startswith("silence for 0.2 s")
        assert "L2+A" in seen["answer"].remedy and seen["state"].level is Level.NOT_HERE


def test_nobody_there_is_a_failure_that_says_what_the_socket_said():
    with emulator(deployment()) as there:
        there.switch_off()
        assert "refused" in Examined(there, first_answer_s=0.2)["answer"].found


def test_a_tick_that_stands_is_a_failure():
    with examined(faults=(Fault("stuck tick"),)) as seen:
        assert seen["tick"].level is Level.FAIL and "stands at" in seen["tick"].found


def test_a_hot_motor_is_named_and_that_it_follows_nothing():
    def heat(robot):
        robot._motors.temperature[4] = 120.0

    with examined(prepare=heat) as seen:
        assert seen["motors"].level is Level.FAIL and seen["motors"].found.startswith("FR_thigh 1")
        assert seen["motor modes"].level is Level.FAIL and "FR_thigh 08" in seen["motor modes"].found


def test_damaged_packets_are_counted():
    with examined(states=Wire(corrupt=0.5)) as seen:
        assert seen["answer"].level is Level.OK and seen["damaged"].level is Level.FAIL
        assert "checksum" in seen["damaged"].found


def test_while_a_run_is_up_nothing_is_sent(tmp_path):
    namespace = f"test-{os.getpid()}-{tmp_path.name}"
    path = socket_path(namespace)
    path.parent.mkdir(mode=0o700, exist_ok=True)
    with socket.socket(socket.AF_UNIX) as hub, emulator(deployment(namespace=namespace)) as there:
        hub.bind(str(path))
        hub.listen()
        try:
            seen = Examined(there)
        finally:
            path.unlink()
        assert there.robot.commands == 0 and seen.said == []
    assert seen["local port"].level is Level.WARN and "a run is up" in seen["local port"].found
    assert "nothing was sent: a run is up" in seen["link"].found


def test_a_simulated_robot_has_no_wire():
    findings = examine_robot(Deployment(), pytest.fail)
    assert {finding.level for group in findings.values() for finding in group} == {Level.NOT_HERE}


def test_it_is_told_in_lines_and_in_json():
    with examined(faults=(Fault("stuck tick"),)) as seen:
        lines, told = "\n".join(as_lines(seen.findings)), json.loads(as_json(seen.findings))
    assert (
        "fail" in lines and "tick: it stands at" in lines and "; expected a tick that moves. its control" in lines
    )
    assert told["ok"] is False and "tick" in [finding["check"] for finding in told["groups"]["link"]]


@pytest.mark.parametrize("broken", [False, True])
def test_the_exit_code_is_that_of_the_worst(broken, capsys, tmp_path):
    settings = [
        f"run.log_dir={tmp_path}",
        "doctor.watch_s=0.2",
        "doctor.free_fail_gb=0.0",
        "doctor.free_warn_gb=0.01",
    ]
    settings += ["hw.backend=aliengo", "hw.aliengo.exchange=cycle", "hw.aliengo.address=127.0.0.1"] * broken
    settings += ["hw.aliengo.first_answer_s=0.1", "hw.aliengo.local_port=0"] * broken
    call = ["doctor", "flat", "--json", *(word for setting in settings for word in ("--set", setting))]
    assert main(call) == int(broken)
    assert json.loads(capsys.readouterr().out)["ok"] is not broken
