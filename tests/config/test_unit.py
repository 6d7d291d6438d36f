"""A robot file comes back as it was written, and what cannot be meant is refused."""

from dataclasses import replace

import pytest

from surefoot.config.typed_toml import ConfigError
from surefoot.config.unit import Accelerometer, FootScale, Friction, Gyroscope, Measured, Torque, Unit, load_unit
from surefoot.tools.calibration.unit_file import known_unit, now, write_unit

WARM = Measured("2026-01-31T12:00+00:00", "hung", 10.0, temperature=31.5)
TWELVE = tuple(0.125 * n for n in range(12))
UNIT = Unit(
    "aliengo",
    gyroscope=Gyroscope(WARM, (0.001, -0.0025, 1e-6)),
    accelerometer=Accelerometer(
        replace(WARM, pose="standing", temperature=None), (0.0, 0.05, -0.125), "level floor"
    ),
    torque=Torque(WARM, tuple(-each for each in TWELVE), TWELVE),
    friction=Friction(WARM, TWELVE, TWELVE, TWELVE, TWELVE),
)


def test_a_file_comes_back_as_it_was_written(tmp_path):
    path = tmp_path / "unit.toml"
    write_unit(path, UNIT)
    assert load_unit(path, "aliengo") == UNIT
    assert UNIT.parts == ("gyroscope", "accelerometer", "torque", "friction")
    assert known_unit(tmp_path / "none.toml", "aliengo") == Unit("aliengo")
    assert now().endswith("+00:00")


@pytest.mark.parametrize(
    ("old", "new", "words"),
    [
        ('robot = "aliengo"', 'robot = "go1"', "is of robot 'go1', not 'aliengo': check hw.unit"),
        ("bias = [0.001", "bias = [1.5", r"gyroscope.bias\[0\] = 1.5: out of range, allowed -1 to 1"),
        ("bias = [0.001, ", "bias = [", "gyroscope.bias .* expected 3 entries, got 2"),
        ("offset", "ofset", "torque.ofset: unknown key; did you mean torque.offset"),
        ('pose = "hung"', 'pose = "sitting"', "must be one of 'standing', 'hung'"),
    ],
)
def test_what_cannot_be_meant_is_refused_by_name(tmp_path, old, new, words):
    path = tmp_path / "unit.toml"
    write_unit(path, UNIT)
    path.write_text(path.read_text().replace(old, new))
    with pytest.raises(ConfigError, match=f"unit.toml.* ?{words}"):
        load_unit(path, "aliengo")


def test_a_scale_needs_its_zero():
    with pytest.raises(ConfigError, match="foot_scale without foot_zero"):
        Unit("aliengo", foot_scale=FootScale(WARM, (1.0,) * 4, 0.0))
