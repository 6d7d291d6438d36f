"""An emulator in this process, on a port of its own."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from threading import Event, Thread

from surefoot.config.deployment import Deployment
from surefoot.hw.emulator.server import EmulatorServer
from surefoot.hw.mujoco.backend import MujocoRobot


class Emulation:
    """A server that is up, on a thread, until it is switched off.

    Attributes:
        server: what is served.
        robot: who answers.
        deployment: the one that it was made of, with its port, and any local one, in it.
    """

    def __init__(self, deployment: Deployment, prepare: Callable[[MujocoRobot], None] = lambda plant: None):
        """`prepare` is given the simulated robot before anything moves."""
        self.server = EmulatorServer(deployment, port=0)
        self.robot = self.server.robot
        prepare(self.robot.plant)
        wire = replace(deployment.hw.aliengo, port=self.server.port, local_port=0)
        self.deployment = replace(deployment, hw=replace(deployment.hw, aliengo=wire))
        self._ended = Event()
        self._thread = Thread(target=self.server.serve, args=(self._ended.is_set,), name="emulator", daemon=True)
        self._thread.start()

    def switch_off(self) -> None:
        """From now on nobody listens at its port."""
        self._ended.set()
        self._thread.join()
