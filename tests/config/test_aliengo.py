"""The settings of the real robot are refused where nothing could work with them."""

from pathlib import Path

import pytest

import surefoot.config.aliengo as aliengo_module
from surefoot.config.aliengo import Aliengo
from surefoot.config.deployment import load_deployment
from surefoot.config.typed_toml import ConfigError, build

CONFIG = Path(aliengo_module.__file__).parent


def test_the_emulated_robot_differs_from_the_real_one_by_its_address_only():
    real, emulated = (load_deployment(CONFIG / f"{name}.toml") for name in ("aliengo", "aliengo_emulated"))
    assert (real.hw.aliengo.address, emulated.hw.aliengo.address) == ("192.168.123.10", "127.0.0.1")
    assert load_deployment(CONFIG / "aliengo.toml", ["hw.aliengo.address=127.0.0.1"]) == emulated


def test_the_real_robot_is_commanded_by_people_only_and_asks_whether_they_are_there():
    deployment = load_deployment(CONFIG / "aliengo.toml")
    run = deployment.run
    assert run.clock == "monotonic" and run.command == "" and deployment.operator.heartbeat_s == 2.0


@pytest.mark.parametrize(
    ("table", "said"),
    [
        ({"address": " "}, r"hw\.aliengo: address is empty: give the robot's"),
        ({"generation": "G2"}, r"hw\.aliengo\.generation = 'G2': must be one of 'G0', 'G1'"),
        ({"chords": {"cut": ["L3"]}}, r"hw\.aliengo\.chords\.cut\[0\] = 'L3': must be one of 'R1'"),
        ({"chords": {"settle": ["L2", "B"], "cut": ["B"]}}, r"cut = \['B'\] is held with settle"),
        ({"port": 0}, r"hw\.aliengo\.port = 0: out of range, allowed 1 to 65535"),
        (
            {"plausible": {"temperature_min": 130.0}},
            r"plausible: temperature_min = 130\.0 is above temperature_max",
        ),
    ],
)
def test_what_cannot_work_is_named(table, said):
    with pytest.raises(ConfigError, match=said):
        build(Aliengo, table, "hw.aliengo")
