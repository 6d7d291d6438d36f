"""The settings of the real robot are refused where nothing could work with them."""

import pytest

from surefoot.config.aliengo import Aliengo
from surefoot.config.typed_toml import ConfigError, build, to_table


def test_the_defaults_are_within_their_limits():
    assert build(Aliengo, to_table(Aliengo()), "hw.aliengo") == Aliengo()


@pytest.mark.parametrize(
    ("table", "said"),
    [
        ({"address": " "}, r"hw\.aliengo: address is empty: give the robot's"),
        ({"generation": "G2"}, r"hw\.aliengo\.generation = 'G2': must be one of 'G0', 'G1'"),
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
