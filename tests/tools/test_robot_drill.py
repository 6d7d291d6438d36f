"""A robot that is lost is damped within its time, and a link that is bad for a moment is passed over."""

from pathlib import Path

import pytest

import surefoot.config.deployment as deployment_module
from surefoot.tools.faults.robot_drill import RobotDrill, RobotResult
from surefoot.tools.faults.robot_fault import FAULTS
from surefoot.tools.faults.robot_page import results_page

CONFIG = Path(deployment_module.__file__).parent / "planks_emulated.toml"
BY_NAME = {fault.name: fault for fault in FAULTS}


@pytest.mark.parametrize("name", ["every state lost", "hot motor", "both ways lost for 30 ms", "dead motor"])
def test_a_robot_that_stands_ends_as_declared(name):
    drill = RobotDrill(CONFIG, ["mpc.profile=light"])
    result = drill.carry_out(BY_NAME[name], "standing")
    assert result.good and result.outcome == "upright", result
    if name == "hot motor":
        assert 3 < result.damped_after <= drill.limit_cycles(result.fault) == 7 and "91 deg C" in result.told
    if name == "dead motor":
        assert result.damped_after > 25 and result.told.startswith("gate: stopped (motor of RL_calf makes")
    if name == "every state lost":
        assert 25 < result.damped_after <= drill.limit_cycles(result.fault) == 32 and result.told != ""


def test_what_did_not_go_as_declared_is_bold_on_the_page():
    silent, twice = BY_NAME["silent robot"], BY_NAME["every packet twice"]
    results = [
        RobotResult(silent, "standing", good=True, damped_after=31, outcome="upright", told="io: no state"),
        RobotResult(silent, "swing", good=False, damped_after=None, outcome="upright", told=""),
        *(RobotResult(twice, phase, True, None, "upright", "") for phase in ("standing", "swing")),
    ]
    page = results_page(results, lambda fault: 32 if fault is silent else None)
    declared = "damped when the newest state is too old, within 32 cycles"
    assert f"| silent robot | {declared} | damped after 31 cycles, upright | **driven on, upright** |" in page
    assert "| every packet twice | goes on | driven on, upright | driven on, upright |" in page
    assert "- silent robot: `io: no state`" in page
