"""The Aliengo of a deployment."""

from __future__ import annotations

from surefoot.config.deployment import Deployment
from surefoot.hw.aliengo.driver import AliengoDriver
from surefoot.hw.aliengo.lockstep_driver import LockstepDriver
from surefoot.hw.robot_interface import RobotInterface


def open_aliengo(deployment: Deployment) -> RobotInterface:
    """The robot on its wire, damping; where `hw.aliengo.exchange` says so an emulator that waits.

    Raises:
        HardwareFault: there is no way to it, or it does not answer.
    """
    settings = deployment.hw
    robot = deployment.load_robot()
    if settings.aliengo.exchange == "cycle":
        return LockstepDriver(robot, settings.aliengo, settings.damping_kd)
    return AliengoDriver(robot, settings.aliengo, settings.damping_kd)
