"""A robot file takes its offsets off the sensors, and nothing else changes; without one nothing does."""

from dataclasses import replace

import numpy as np
import pytest

from surefoot.components.io.io import Io
from surefoot.config.deployment import Deployment
from surefoot.config.hw import Hw
from surefoot.config.typed_toml import ConfigError
from surefoot.config.unit import Accelerometer, FootScale, FootZero, Gyroscope, Measured, Torque, Unit
from surefoot.hw.calibrated_robot import CalibratedRobot
from surefoot.hw.mujoco.backend import MujocoRobot
from surefoot.hw.robot_interface import damping_law
from surefoot.tools.calibration.unit_file import write_unit

MADE = Measured("2026-01-31T12:00+00:00", "hung", 10.0)
OFFSETS = Unit(
    "aliengo",
    gyroscope=Gyroscope(MADE, (0.01, -0.02, 0.03)),
    accelerometer=Accelerometer(MADE, (0.1, -0.2, 0.3), "attitudes"),
    torque=Torque(MADE, tuple(0.1 * n for n in range(12)), (0.5,) * 12),
    foot_zero=FootZero(MADE, (10.0, 20.0, 30.0, 40.0)),
    foot_scale=FootScale(MADE, (0.5, 1.0, 2.0, 4.0), 0.02),
)


class Feet(MujocoRobot):
    """The simulated robot, with foot sensors."""

    def read(self):
        return replace(super().read(), foot_force=np.array([110.0, 120.0, 130.0, 140.0]))


def test_its_offsets_are_taken_off_and_the_rest_stays():
    raw, corrected = Feet(Deployment()).read(), CalibratedRobot(Feet(Deployment()), OFFSETS).read()
    np.testing.assert_allclose(raw.omega_WB_B - corrected.omega_WB_B, OFFSETS.gyroscope.bias)
    np.testing.assert_allclose(raw.acc_B - corrected.acc_B, OFFSETS.accelerometer.bias)
    np.testing.assert_allclose(raw.tau - corrected.tau, OFFSETS.torque.offset)
    np.testing.assert_allclose(corrected.foot_force, [50.0, 100.0, 200.0, 400.0])
    assert (raw.q == corrected.q).all() and (raw.dq == corrected.dq).all() and raw.t is corrected.t is None


def test_it_is_driven_as_the_robot_itself():
    bare, wrapped = MujocoRobot(Deployment()), CalibratedRobot(MujocoRobot(Deployment()), Unit("aliengo"))
    for robot in (bare, wrapped):
        for _ in range(20):
            robot.write(damping_law(2.0))
            robot.advance()
        robot.advance()
    assert bare.read().acc_B.tobytes() == wrapped.read().acc_B.tobytes()
    assert bare.truth().q.tobytes() == wrapped.truth().q.tobytes()
    assert wrapped.depth() is None and wrapped.read().foot_force is None and wrapped.trouble == ""


def test_io_corrects_only_what_a_deployment_names(tmp_path):
    assert type(Io(Deployment()).robot) is MujocoRobot
    path = tmp_path / "unit.toml"
    write_unit(path, OFFSETS)
    assert type(Io(Deployment(hw=Hw(unit=str(path)))).robot) is CalibratedRobot
    with pytest.raises(ConfigError, match=r"no such file: nowhere\.toml"):
        Io(Deployment(hw=Hw(unit="nowhere.toml")))
