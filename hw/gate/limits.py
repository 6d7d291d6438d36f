"""The figures that joints are held to."""

from __future__ import annotations

import numpy as np

from surefoot.config.gate import Gate as Settings
from surefoot.config.robot import Robot


class Limits:
    """Of one robot, joint by joint.

    Attributes:
        lower, upper: (12,) angles [rad].
        speed: (12,) of a command [rad/s].
        measured_speed: (12,) of a joint [rad/s].
        torque: (12,) [N m].
    """

    def __init__(self, robot: Robot, settings: Settings):
        self.lower, self.upper = np.array(robot.position_range()).T.copy()
        self.speed = np.array(robot.per_joint("velocity_limit"))
        self.measured_speed = settings.speed_share * self.speed
        self.torque = settings.torque_share * np.array(robot.per_joint("torque_limit"))
