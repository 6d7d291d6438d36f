"""A robot whose sensors are corrected by what was measured of it."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from surefoot.bus.messages import SimTruth
from surefoot.config.unit import Unit
from surefoot.hw.robot_interface import DepthImage, MotorLaw, RobotInterface, Sensors


class CalibratedRobot:
    """Takes the offsets of `unit` off every reading; all else is the robot's own.

    Joint friction is not taken off: the torque estimate does not know of it, and whoever estimates forces has it
    in the robot's figures.
    """

    def __init__(self, robot: RobotInterface, unit: Unit):
        self._robot = robot
        gyroscope, accelerometer, torque = unit.gyroscope, unit.accelerometer, unit.torque
        zero, scale = unit.foot_zero, unit.foot_scale
        self._gyro_bias = np.array(gyroscope.bias if gyroscope else np.zeros(3))
        self._acc_bias = np.array(accelerometer.bias if accelerometer else np.zeros(3))
        self._tau_offset = np.array(torque.offset if torque else np.zeros(12))
        self._foot_zero = np.array(zero.raw if zero else np.zeros(4))
        self._foot_scale = np.array(scale.force if scale else np.ones(4))

    @property
    def trouble(self) -> str:
        return self._robot.trouble

    def read(self) -> Sensors:
        told = self._robot.read()
        feet = told.foot_force
        return replace(
            told,
            tau=told.tau - self._tau_offset,
            omega_WB_B=told.omega_WB_B - self._gyro_bias,
            acc_B=told.acc_B - self._acc_bias,
            foot_force=None if feet is None else self._foot_scale * (feet - self._foot_zero),
        )

    def depth(self) -> DepthImage | None:
        return self._robot.depth()

    def write(self, law: MotorLaw) -> None:
        self._robot.write(law)

    def advance(self) -> None:
        self._robot.advance()

    def truth(self) -> SimTruth | None:
        return self._robot.truth()

    def close(self) -> None:
        self._robot.close()
