"""The Aliengo of a deployment."""

from __future__ import annotations

from surefoot.config.deployment import Deployment
from surefoot.hw.aliengo.driver import AliengoDriver
from surefoot.hw.robot_interface import RobotInterface


def open_aliengo(deployment: Deployment) -> RobotInterface:
    """The robot on its wire, damping, or an emulator that waits where `hw.aliengo.exchange` says so.

    Raises:
        HardwareFault: there is no way to it, or it does not answer.
    """
    settings = deployment.hw
    return AliengoDriver(deployment.load_robot(), settings.aliengo, settings.damping_kd)
