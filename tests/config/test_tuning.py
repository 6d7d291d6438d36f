"""What may be changed while the robot runs, within the same limits as in a file, and written down as one."""

import tomllib
from pathlib import Path

import pytest

import surefoot.config.deployment as deployment_module
from surefoot.config.deployment import Deployment, load_deployment
from surefoot.config.deployment_file import deployment_text
from surefoot.config.tuning import Tunings, assignment_of, tunable_settings, tuned, value_of
from surefoot.config.typed_toml import ConfigError, build

FILES = sorted(Path(deployment_module.__file__).parent.glob("*.toml"))


def test_weights_gains_and_thresholds_are_tunable_and_no_limit_of_a_safeguard_is():
    settings = tunable_settings()
    for path in ("ocp.weights.force", "wbc.kp", "fsm.collapse_m", "trajopt.envelope_scale", "fsm.cap_forces"):
        assert path in settings
    assert {path.partition(".")[0] for path in settings} == {"ocp", "trajopt", "wbc", "fsm"}
    for path in ("fsm.tilt_max", "fsm.tilt_hold", "fsm.margin_hold_m", "fsm.hold_error", "ocp.force_max_n"):
        assert path not in settings
    assert all(setting.limits is not None for path, setting in settings.items() if not on_or_off(path))


def on_or_off(path):
    return isinstance(value_of(Deployment(), path), bool)


def test_every_value_as_it_is_changes_nothing():
    deployment = Deployment()
    assert tuned(deployment, [assignment_of(deployment, path) for path in tunable_settings()]) == deployment


@pytest.mark.parametrize(
    ("assignment", "why"),
    [
        ("wbc.kp=-1", "wbc.kp = -1.0: out of range, allowed 0 to 10000"),
        ("wbc.wrench_weight=[1, 2]", "wbc.wrench_weight = .*: expected 6 entries, got 2"),
        ("wbc.kp=stiff", "wbc.kp = 'stiff': expected float"),
        ("wbc.kp=nan", "wbc.kp = nan: expected a finite number"),
        ("fsm.cap_forces=1", "fsm.cap_forces = 1: expected bool"),
        ("ocp.probing_force.delta=0", "ocp.probing_force.delta = 0.0: out of range, allowed 0.0001 to 10"),
        ("fsm.step_m=0.01", "fsm: step_min_m = 0.05 is not below step_m = 0.01"),
        ("wbc.joint_kp=600", "wbc.joint_kp = 600.0 is above hw.kp_max"),
        ("fsm.fixed_force_n=300", "fsm.fixed_force_n = 300.0 is above ocp.force_max_n"),
        ("hw.kp_max=1000", "hw.kp_max: not to be changed while the robot runs"),
        ("fsm.collapse=0.02", "did you mean fsm.collapse_m"),
        ("wbc.kp", "write it as section.key=value"),
    ],
)
def test_what_a_file_would_be_refused_for_is_refused_and_nothing_changes(assignment, why):
    tunings = Tunings(Deployment())
    before = tunings.change("wbc.kd=21")
    with pytest.raises(ConfigError, match=why):
        tunings.change(assignment)
    assert tunings.assignments == before == ("wbc.kd=21.0",)


def test_each_setting_stands_once_the_latest_change_last():
    tunings = Tunings(Deployment())
    for assignment in ("wbc.kp=90", "fsm.cap_forces=true", "wbc.kp=95"):
        changed = tunings.change(assignment)
    assert changed == ("fsm.cap_forces=true", "wbc.kp=95.0")
    assert tuned(tunings.begun, changed).wbc.kp == 95.0 and tunings.begun.wbc.kp == 100.0


@pytest.mark.parametrize("path", FILES, ids=lambda path: path.stem)
def test_a_deployment_is_written_as_the_file_that_makes_it(path):
    begun = load_deployment(path)
    now = tuned(begun, ["wbc.wrench_weight=[1, 1, 2, 2, 2, 3]", "fsm.collapse_m=0.025", "ocp.force_limits.mu=2"])
    text = deployment_text(now, {"fsm.collapse_m": "tuned"})
    assert build(Deployment, tomllib.loads(text)) == now
    assert "collapse_m = 0.025  # tuned" in text and "epoch_s" not in text


def test_a_file_holds_what_differs_from_the_defaults():
    assert deployment_text(Deployment(), {}) == "\n"
    assert deployment_text(tuned(Deployment(), ["wbc.kp=90"]), {}) == "[wbc]\nkp = 90.0\n"
