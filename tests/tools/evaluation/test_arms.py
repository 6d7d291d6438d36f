"""An arm is a change of settings that a deployment really takes."""

import pytest

from surefoot.config.deployment import load_deployment
from surefoot.config.typed_toml import ConfigError
from surefoot.tools.evaluation.arms import ARMS, arm_overrides


@pytest.fixture
def fsm(tmp_path):
    path = tmp_path / "any.toml"
    path.write_text("")
    return lambda arm: load_deployment(path, arm_overrides(arm)).fsm


def test_every_arm_changes_what_its_name_says(fsm):
    plain = fsm("full")
    assert plain.probing and plain.support_polygon and plain.probe_around and plain.fixed_force_n == 0.0
    baseline = fsm("mpc_only")
    assert not baseline.probing and not baseline.support_polygon
    assert not fsm("no_support_polygon").support_polygon and fsm("no_support_polygon").probing
    assert not fsm("no_probe_around").probe_around and fsm("no_probe_around").probing
    assert fsm("fixed_force=80").fixed_force_n == 80.0
    assert fsm("threshold=0.02").collapse_m == 0.02


@pytest.mark.parametrize("arm", ["blindfold", "", "full=3", "threshold", "threshold=", "=3"])
def test_an_unknown_arm_is_answered_with_those_there_are(arm):
    with pytest.raises(ConfigError) as told:
        arm_overrides(arm)
    for known in (*ARMS, "fixed_force=FIGURE", "threshold=FIGURE"):
        assert known in str(told.value)
    assert repr(arm) in str(told.value)


def test_a_figure_that_is_none_is_named(fsm):
    with pytest.raises(ConfigError, match=r"fsm\.collapse_m = 'thick'"):
        fsm("threshold=thick")
