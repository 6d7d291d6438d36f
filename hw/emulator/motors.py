"""Twelve motors: what they make of a command, of silence and of their own heat."""

from __future__ import annotations

from math import exp, inf

import numpy as np

from surefoot.config.emulator import Motors as Settings
from surefoot.config.robot import Robot
from surefoot.hw.aliengo.command_packet import BRAKE, SERVO, AliengoCommand
from surefoot.hw.emulator.broken_parts import BrokenParts
from surefoot.hw.robot_interface import MotorLaw, damping_law

OVERHEATED = 0x08
"""Mode of a motor that brakes because it is too hot, as another robot of the vendor's tells it."""


class Motors:
    """Brake until the first command.

    Attributes:
        temperature: (12,) [deg C].
    """

    def __init__(self, robot: Robot, settings: Settings, broken: BrokenParts):
        self._settings, self._broken = settings, broken
        self._lower, self._upper = np.array(robot.position_range()).T
        self._command = AliengoCommand(damping_law(0.0), braked=np.full(12, True))
        self._heard_t = inf
        self.temperature = np.full(12, settings.ambient)
        self._hot = np.full(12, False)

    @property
    def mode(self) -> np.ndarray:
        """(12,) what each motor says that it does; a dead one does not know that it is."""
        asked = np.where(self._command.braked, BRAKE, SERVO)
        return np.where(self._hot, OVERHEATED, asked).astype(np.uint8)

    def command(self, command: AliengoCommand, t: float) -> None:
        """A command has come at time `t` [s]."""
        self._command, self._heard_t = command, t

    def law(self, t: float) -> MotorLaw:
        """The law that acts at time `t` [s]."""
        settings, law = self._settings, self._command.law
        silent = t - self._heard_t > settings.silence_s and settings.on_silence == "brake"
        braked = self._command.braked | self._hot | silent
        alive = ~self._broken.joints("dead motor", t)
        follows = alive & ~braked
        q = np.clip(law.q, self._lower, self._upper) if settings.clamp_angles else law.q
        tau = np.clip(law.tau, -settings.clamp_torque, settings.clamp_torque)
        return MotorLaw(
            q=q,
            dq=np.where(follows, law.dq, 0.0),
            kp=np.where(follows, law.kp, 0.0),
            kd=np.where(follows, law.kd, settings.brake_kd * (alive & braked)),
            tau=np.where(follows, tau, 0.0),
        )

    def warm(self, tau: np.ndarray, seconds: float, t: float) -> None:
        """Heat up or cool down by torques (12,) [N m] that have acted so long until time `t` [s]."""
        settings = self._settings
        end = settings.ambient + settings.heating * tau**2
        self.temperature = end + (self.temperature - end) * exp(-seconds / settings.heating_s)
        self.temperature[self._broken.joints("hot motor", t)] = settings.overheated + 1.0
        self._hot = self.temperature > np.where(self._hot, settings.cooled, settings.overheated)
