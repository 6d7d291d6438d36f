"""What a deployment refuses, and what a profile of the MPC means."""

import pytest

from surefoot.bus.topics import processes
from surefoot.config.deployment import Deployment, Run, load_deployment
from surefoot.config.typed_toml import ConfigError


def test_the_default_run_is_simulated():
    assert Deployment().run == Run() and Run().clock == "simulated"


@pytest.mark.parametrize(
    ("text", "named"),
    [
        ('[terrain]\nkind = "flat\n', r"test\.toml is not valid TOML: .*line 2"),
        (
            "[hw]\nfriction_mn = 0.3\n",
            r"test\.toml: hw\.friction_mn: unknown key; did you mean hw\.friction_min\?",
        ),
        ("[hw]\ncommand_timeout_s = 'long'\n", r"hw\.command_timeout_s = 'long': expected float"),
        ("[hw]\ncommand_timeout_s = 5.0\n", r"hw\.command_timeout_s = 5\.0: out of range, allowed 0\.004 to 1"),
        ("[hw]\nfriction_min = 0.9\n", r"hw: friction_min = 0\.9 is above friction_max = 0\.8"),
        ("[wbc]\nkp = nan\n", r"wbc\.kp = nan: expected a finite number"),
        ("[run]\nnamespace = 'a/b'\n", r"run: namespace = 'a/b'"),
        ("[mpc]\nprofile = 'fast'\n", r"mpc\.profile = 'fast': must be one of 'paper', 'light'"),
    ],
)
def test_a_mistake_names_file_key_value_and_what_would_be_right(tmp_path, text, named):
    path = tmp_path / "test.toml"
    path.write_text(text)
    with pytest.raises(ConfigError, match=named):
        load_deployment(path)


def test_a_folder_and_an_override_below_a_value_are_named(tmp_path):
    with pytest.raises(ConfigError, match="is a folder"):
        load_deployment(tmp_path)
    path = tmp_path / "test.toml"
    path.write_text("robot = 'aliengo'\n")
    with pytest.raises(ConfigError, match="robot is 'aliengo', not a section"):
        load_deployment(path, ["robot.mass=3"])


def test_a_profile_sets_horizon_and_rate_and_a_figure_given_wins(tmp_path):
    path = tmp_path / "test.toml"
    path.write_text("[mpc]\nprofile = 'light'\nlead_s = 0.03\n")
    light, paper = load_deployment(path).mpc, Deployment().mpc
    assert (paper.intervals, paper.interval_s, paper.lead_s) == (67, 0.015, 0.015)
    assert (light.intervals, light.interval_s, light.lead_s) == (40, 0.025, 0.03)
    assert [processes(name)["mpc"].rate_hz for name in ("paper", "light")] == [100.0, 50.0]
    assert light.lead_s >= processes("light")["mpc"].budget_s
