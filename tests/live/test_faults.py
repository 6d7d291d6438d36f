"""Each process, each phase and each fault once: the run goes on with the same bytes, or the robot damps."""

from pathlib import Path

import pytest

import surefoot.config
from surefoot.tools.faults.case import FAULTS, PHASES, Case
from surefoot.tools.faults.drill import Drill

CONFIG = Path(next(iter(surefoot.config.__path__)))

CASES = {
    "flat": (
        ("standing", "restart", "trajopt"),
        ("standing", "pause", "mpc"),
        ("base shift", "kill", "wbc"),
        ("base shift", "pause", "io"),
        ("swing", "kill", "fsm"),
        ("swing", "pause", "all"),
        ("probing", "restart", "estimator"),
        ("probing", "kill", "elevation_map"),
        ("probing", "kill", "io"),
    ),
    "planks": (
        ("standing", "pause", "fsm"),
        ("base shift", "restart", "mpc"),
        ("base shift", "kill", "trajopt"),
        ("swing", "kill", "estimator"),
        ("swing", "pause", "elevation_map"),
        ("probing", "restart", "io"),
        ("probing", "pause", "wbc"),
        ("probing", "kill", "mpc"),
    ),
}


def test_the_cover_is_one():
    cases = [case for each in CASES.values() for case in each]
    assert {phase for phase, _, _ in cases} == set(PHASES)
    assert {fault for _, fault, _ in cases} == set(FAULTS)


@pytest.mark.parametrize("terrain", CASES)
def test_with_simulated_time_a_fault_changes_no_byte(terrain, tmp_path):
    cases = [Case(*case) for case in CASES[terrain]]
    settings = ["fsm.probe_around=false", "mpc.profile=light"]
    results = Drill(CONFIG / f"{terrain}.toml", settings, tmp_path).simulated(cases)
    assert [result.case for result in results if not result.good] == [], results
    for result in results:
        assert result.told or result.case.fault == "pause", f"nobody said anything of {result.case}"
        if result.case != Case("probing", "kill", "io"):
            assert "same bytes" in result.outcome
    said = {result.case: result.told for result in results}
    if terrain == "flat":
        assert "wbc ended with signal 9" in said[Case("base shift", "kill", "wbc")]
        assert "io ended with signal 9" in said[Case("probing", "kill", "io")]
    else:
        assert "cannot restart io" in said[Case("probing", "restart", "io")]


@pytest.mark.parametrize("process", ["wbc", "io"])
def test_in_real_time_a_crash_ends_the_run_and_no_old_command_is_ever_applied(process, tmp_path):
    """On a machine too slow for even a fifth of it the robot may be damped before the crash: told, in time."""
    result = Drill(CONFIG / "flat.toml", ["run.speed=0.2"], tmp_path).monotonic(Case("standing", "kill", process))
    if result.outcome.startswith("not reached: the robot was damped"):
        pytest.skip(f"this machine is too busy for a fifth of real time: {result.outcome}")
    assert result.good, result
    # The state machine may see that the chain is broken before the supervisor sees why.
    assert f"{process} ended with signal 9" in result.told or "the robot was damped" in result.told
