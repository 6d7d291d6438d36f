"""The whole stack in this process, and an emulated robot that it speaks to over real sockets."""

from __future__ import annotations

from typing import cast

from surefoot.components.io.io import Io
from surefoot.components.lockstep import Lockstep
from surefoot.config.deployment import Deployment
from surefoot.config.typed_toml import ConfigError
from surefoot.hw.aliengo.driver import AliengoDriver
from surefoot.hw.emulator.emulation import Emulation


class EmulatedStack(Lockstep):
    """Simulated time, in which the emulator takes part by turns.

    Attributes:
        robot: the emulated one.
        io: the component that speaks to it.
        driver: by which.
    """

    def __init__(self, deployment: Deployment):
        """Start the emulator, then build the stack.

        Raises:
            ConfigError: it is not a deployment of an emulated robot in simulated time.
        """
        if deployment.hw.backend != "aliengo" or deployment.hw.aliengo.exchange != "cycle":
            raise ConfigError(
                f"hw.backend = {deployment.hw.backend!r} with hw.aliengo.exchange = "
                f"{deployment.hw.aliengo.exchange!r}: an emulated robot in simulated time is 'aliengo' with "
                "'cycle', as in config/planks_emulated.toml"
            )
        if deployment.emulator.pace != "packets":
            raise ConfigError("emulator.pace = 'wall': its time is to go with the stack's, set 'packets'")
        self._emulation = Emulation(deployment)
        self.robot = self._emulation.robot
        super().__init__(self._emulation.deployment)
        self.io = cast(Io, self.components["io"])
        self.driver = cast(AliengoDriver, self.io.robot)

    def close(self) -> None:
        """Leave the robot damping, and switch it off."""
        self.driver.close()
        self._emulation.switch_off()
