"""The fault drill sees what it is to see: other bytes, old commands, robots that fell, cases not reached."""

from dataclasses import replace

import numpy as np
import pytest

from surefoot.bus.codec import encode
from surefoot.bus.messages import ControlMode, HardwareState, JointCommand, LegStatus, MotionReference
from surefoot.bus.topics import TOPICS
from surefoot.components.lockstep import Lockstep
from surefoot.config.deployment import Deployment
from surefoot.config.typed_toml import ConfigError
from surefoot.tools.cli import main
from surefoot.tools.faults.case import PHASES, Case, Result, all_cases, phase_of
from surefoot.tools.faults.drill import Drill, _applied_too_old
from surefoot.tools.faults.observed_run import KEYS
from surefoot.tools.faults.reference_run import first_difference
from surefoot.tools.faults.safe_state import damped_within_s
from surefoot.tools.faults.table import table

UNTIL_S = 0.1


@pytest.fixture(scope="module")
def heard():
    """A run in one process in which a command comes on the way."""
    stack, heard = Lockstep(Deployment()), {key: [] for key in KEYS}
    stack.listen(lambda key, message: heard[key].append(encode(replace(message, boot=3))))
    stack.command("stand")
    stack.run(0.04)
    stack.command("forward")
    stack.run(UNTIL_S)
    return heard


def test_the_same_run_is_told_from_one_with_other_bytes(heard):
    assert first_difference(Deployment(), heard, UNTIL_S) == (float("inf"), "")
    last = heard["joint/command"][-1]
    other = encode(JointCommand(seq=len(heard["joint/command"]) - 1, tau=np.ones(12)))
    when, where = first_difference(
        Deployment(), heard | {"joint/command": [*heard["joint/command"], other]}, UNTIL_S
    )
    assert 0.09 < when <= UNTIL_S and "joint/command differs" in where
    assert first_difference(Deployment(), heard | {"joint/command": [other, last]}, UNTIL_S)[1].endswith(
        "is missing"
    )


def test_a_command_too_old_is_seen_where_the_cycle_was_not_damped():
    commands = [JointCommand(t=0.1 * k) for k in range(3)]
    states = [HardwareState(t=0.002 * k, damping=k > 125) for k in range(200)]
    assert _applied_too_old(states, commands, 0.05).startswith("at 0.052 s a command of 52 ms was applied")
    assert _applied_too_old(states[100:], commands, 0.05) == ""
    assert _applied_too_old([HardwareState(t=0.26)], commands, 0.05).startswith("at 0.260 s")
    assert "inf" in _applied_too_old([HardwareState(t=0.0)], [], 0.05)
    unheard = [JointCommand(t=0.0, seq=3), JointCommand(t=0.2, seq=53)]
    assert _applied_too_old([HardwareState(t=0.1)], unheard, 0.05) == ""


def test_the_phases_are_those_of_the_references():
    balance = MotionReference(mode=ControlMode.BALANCE, t=1.0)
    lifted = np.array([0, LegStatus.SWING, 0, 0])
    assert phase_of(replace(balance, state="STAND")) == "standing"
    assert phase_of(replace(balance, state="MOVE", base_t1=2.0)) == "base shift"
    assert phase_of(replace(balance, state="MOVE", base_t1=0.5)) == ""
    assert phase_of(replace(balance, state="DETECT_CONTACT", leg_status=lifted)) == "swing"
    assert phase_of(replace(balance, state="PROBE")) == "probing"
    assert phase_of(replace(balance, state="PROBE", mode=ControlMode.DAMP)) == ""


def test_every_process_has_every_fault_and_the_last_one_ends_the_run():
    cases = all_cases("swing")
    writers = {topic.writer for topic in TOPICS.values()} - {"operator"}
    assert {(case.fault, case.process) for case in cases} >= {
        (fault, name) for fault in ("kill", "pause", "restart") for name in writers
    }
    assert cases[-1] == Case("swing", "kill", "io")


def test_what_is_not_reached_or_not_as_declared_is_told_and_bold(tmp_path):
    with pytest.raises(ConfigError, match=r"nothing\.toml"):
        Drill(tmp_path / "nothing.toml", [], tmp_path).monotonic(Case("standing", "kill", "wbc"))
    results = [
        Result(Case("standing", "kill", "wbc"), True, "run over, robot damped", "wbc ended", 0.052),
        Result(Case("swing", "kill", "wbc"), False, "fell", ""),
        Result(Case("swing", "pause", "mpc"), True, "same bytes", ""),
    ]
    assert table(results).splitlines() == [
        "| fault | standing | swing |",
        "|---|---|---|",
        "| kill wbc | run over, robot damped; safe after 0.05 s | **fell** |",
        "| pause mpc | – | same bytes |",
    ]


def test_the_declared_times_are_the_settings():
    deployment = Deployment()
    assert damped_within_s(deployment, "wbc") == pytest.approx(0.052)
    assert damped_within_s(deployment, "estimator") == pytest.approx(0.052)
    assert damped_within_s(deployment, "mpc") == pytest.approx(0.1 + 1.0 + 1.8)
    assert damped_within_s(deployment, "fsm") == pytest.approx(2.9)
    assert damped_within_s(deployment, "trajopt") is None


def test_a_wrong_phase_or_clock_is_told(tmp_path, capsys):
    for option, allowed in (("--phase", PHASES), ("--clock", ("simulated", "monotonic"))):
        assert main(["faults", "flat", option, "flying", "--out", str(tmp_path / "page.md")]) == 2
        assert ", ".join(allowed) in capsys.readouterr().err
