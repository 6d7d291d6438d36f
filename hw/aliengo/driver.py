"""The Aliengo on its wire, real or emulated, behind the robot interface."""

from __future__ import annotations

from surefoot.config.aliengo import Aliengo
from surefoot.config.robot import Robot
from surefoot.hw.aliengo.cycle_exchange import CycleExchange
from surefoot.hw.aliengo.exchange import Exchange
from surefoot.hw.aliengo.law_encoder import LawEncoder
from surefoot.hw.aliengo.link_statistics import LinkRecorder, LinkStatistics
from surefoot.hw.aliengo.plausibility import Plausibility
from surefoot.hw.aliengo.state_feed import TimedState
from surefoot.hw.aliengo.timer_exchange import TimerExchange
from surefoot.hw.errors import PacketError
from surefoot.hw.robot_interface import DepthImage, MotorLaw, Sensors

_EXCHANGES: dict[str, type[TimerExchange] | type[CycleExchange]] = {"timer": TimerExchange, "cycle": CycleExchange}


class AliengoDriver:
    """Makes packets of motor laws and hands over what the robot measured; an exchange carries both.

    It damps from its construction on, in a cycle that brings no law, and at its end.
    """

    def __init__(self, robot: Robot, settings: Aliengo, damping_kd: float):
        """Open the link, damp, and wait for the first good state.

        Args:
            robot: its figures.
            settings: of the link.
            damping_kd: joint damping of the safe state [N m s/rad].

        Raises:
            HardwareFault: there is no way to the robot, or it does not answer.
        """
        plausibility = Plausibility(robot, settings.plausible)
        self._encoder = LawEncoder(settings, plausibility, damping_kd)
        self._recorder = LinkRecorder()
        self._written = False
        exchange = _EXCHANGES[settings.exchange]
        self._exchange: Exchange = exchange(settings, plausibility, self._encoder.damp, self._recorder)

    @property
    def newest(self) -> TimedState:
        """All that the robot told in its newest state, and when that was. Raises as `read`."""
        return self._exchange.newest

    @property
    def statistics(self) -> LinkStatistics:
        """How well the exchange goes."""
        return self._recorder.statistics()

    @property
    def trouble(self) -> str:
        """What of the last law did not fit the packet; what was amiss on the link in the last `TOLD_S` seconds."""
        return "; ".join(words for words in (*self._encoder.limited, self._recorder.trouble) if words)

    def read(self) -> Sensors:
        return self._exchange.read()

    def depth(self) -> DepthImage | None:
        """None: the robot has no camera on this link."""
        return None

    def write(self, law: MotorLaw) -> None:
        """The motor law of this cycle.

        Raises:
            PacketError: no robot could follow it; the motors damp.
        """
        try:
            packet = self._encoder.packet(law)
        except PacketError:
            self._exchange.order(None)
            raise
        self._exchange.order(packet)
        self._written = True

    def advance(self) -> None:
        """End the cycle; one without a law damps. Whether the robot answered is `read`'s to say."""
        if not self._written:
            self._exchange.order(None)
        self._written = False
        self._exchange.end_cycle()

    def truth(self) -> None:
        """None: nobody knows it."""

    def close(self) -> None:
        """Leave the robot damping, and end."""
        self._exchange.close()
