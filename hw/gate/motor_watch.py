"""Whether the motors do what their laws ask of them."""

from __future__ import annotations

import numpy as np

from surefoot.config.gate import Gate as Settings
from surefoot.config.robot import JOINT_NAMES, Robot
from surefoot.hw.gate.check import Check, Violation
from surefoot.hw.robot_interface import MotorLaw, Sensors

_LAWS = 15
"""So many cycles back a law may be the one that a reading tells of: 30 ms, commands and states on their way."""


class MotorWatch:
    """Compares torques as measured with those that the latest laws make of the measured angles and speeds.

    Which of them acted when the torque was measured nobody knows: what lies between the least and the largest of
    their torques is well. Beyond that a motor may be off by a figure and by a share of what is asked: the torque
    estimate has its noise and its scale, joint friction is no part of it, and a motor ends at its limit.
    """

    def __init__(self, robot: Robot, settings: Settings):
        self._off, self._share = settings.motor_torque_off, settings.motor_torque_share
        self._most = settings.motor_off_cycles
        self._limit = np.array(robot.per_joint("torque_limit"))
        self._next = 0
        self._constant, self._kp, self._kd = np.zeros((3, _LAWS, 12))
        self._over = np.zeros(12, int)

    def sent(self, law: MotorLaw) -> None:
        """A law has gone to the motors."""
        self._constant[self._next] = law.tau + law.kp * law.q + law.kd * law.dq
        self._kp[self._next], self._kd[self._next] = law.kp, law.kd
        self._next = (self._next + 1) % _LAWS

    def violation(self, sensors: Sensors, driven: bool) -> Violation | None:
        """Look at a new reading, of a robot that is driven, or not."""
        if not driven:
            self._over[:] = 0
            return None
        asked = self._constant - self._kp * sensors.q - self._kd * sensors.dq
        nearest = np.minimum(np.maximum(sensors.tau, asked.min(axis=0)), asked.max(axis=0))
        nearest = np.minimum(np.maximum(nearest, -self._limit), self._limit)
        off = np.abs(sensors.tau - nearest) > self._off + self._share * np.abs(nearest)
        self._over = np.where(off, self._over + 1, 0)
        joint = int(np.argmax(self._over))
        if self._over[joint] <= self._most:
            return None
        return Violation(
            Check.MOTOR,
            f"motor of {JOINT_NAMES[joint]} makes {sensors.tau[joint]:.1f} N m where {nearest[joint]:.1f} N m are "
            f"asked of it, for {self._over[joint]} cycles, limit {self._most}",
        )
