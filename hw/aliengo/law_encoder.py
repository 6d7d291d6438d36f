"""What a driver sends: motor laws, and the packet of the safe state."""

from __future__ import annotations

from surefoot.config.aliengo import Aliengo
from surefoot.hw.aliengo.command_packet import encode_brake, encode_command
from surefoot.hw.aliengo.generation import GENERATIONS
from surefoot.hw.aliengo.plausibility import Plausibility
from surefoot.hw.robot_interface import MotorLaw, damping_law


class LawEncoder:
    """Makes packets for one robot.

    Attributes:
        damp: the packet of the safe state.
        limited: in words what of the last law did not fit its packet; empty when all did.
    """

    def __init__(self, settings: Aliengo, plausibility: Plausibility, damping_kd: float):
        """`damping_kd`: joint damping of the safe state [N m s/rad]."""
        self._generation, self._plausibility = GENERATIONS[settings.generation], plausibility
        self.limited: tuple[str, ...] = ()
        if settings.damping == "brake":
            self.damp = encode_brake(self._generation)
        else:
            self.damp, _ = encode_command(damping_law(damping_kd), self._generation, plausibility)

    def packet(self, law: MotorLaw) -> bytes:
        """The packet of a law.

        Raises:
            PacketError: no robot could follow it.
        """
        packet, self.limited = encode_command(law, self._generation, self._plausibility)
        return packet
