"""An emulated Aliengo whose time waits, behind the robot interface."""

from __future__ import annotations

from dataclasses import replace
from time import monotonic

from surefoot.config.aliengo import Aliengo
from surefoot.config.robot import Robot
from surefoot.hw.aliengo.complaint import complaint
from surefoot.hw.aliengo.law_encoder import LawEncoder
from surefoot.hw.aliengo.link import Link
from surefoot.hw.aliengo.link_statistics import LinkRecorder, LinkStatistics
from surefoot.hw.aliengo.plausibility import Plausibility
from surefoot.hw.aliengo.state_feed import StateFeed
from surefoot.hw.errors import HardwareFault, PacketError
from surefoot.hw.robot_interface import DepthImage, MotorLaw, Sensors

_AGAIN_S = 1.0  # until a packet counts as lost: an answer that is only late would cost the robot a cycle


class LockstepDriver:
    """Exchanges one command for one state in each cycle of the caller, which waits for it.

    For an emulator paced by packets: with every command its time goes on by a cycle, so that simulated time may
    wait and a slow machine changes nothing. What is lost is sent again, and costs the robot a cycle that is not
    counted here.
    """

    def __init__(self, robot: Robot, settings: Aliengo, damping_kd: float):
        """Open the link, damp, and wait for the first good state; as `AliengoDriver`.

        Raises:
            HardwareFault: there is no way to the robot, or it does not answer.
        """
        self._settings = settings
        plausibility = Plausibility(robot, settings.plausible)
        self._encoder = LawEncoder(settings, plausibility, damping_kd)
        self._packet: bytes | None = None
        self._recorder = LinkRecorder()
        self._feed = StateFeed(settings, plausibility, self._recorder)
        self._link = Link(settings, self._recorder)
        self._exchange(self._encoder.damp)
        if not self._answered:
            self.close()
            raise HardwareFault(complaint(settings, self.statistics, None))

    @property
    def statistics(self) -> LinkStatistics:
        """How well the exchange goes."""
        return self._recorder.statistics()

    @property
    def trouble(self) -> str:
        """What of the last law did not fit the packet; what was last amiss on the link."""
        return "; ".join(words for words in (*self._encoder.limited, self._recorder.trouble) if words)

    def read(self) -> Sensors:
        """What the last cycle was answered by; it was measured at this instant, since time has waited."""
        newest = self._feed.newest
        if not self._answered or newest is None:
            age_s = None if newest is None else monotonic() - newest.t
            raise HardwareFault(complaint(self._settings, self.statistics, age_s))
        return replace(newest.sensors, t=None)

    def depth(self) -> DepthImage | None:
        """None: the robot has no camera on this link."""
        return None

    def write(self, law: MotorLaw) -> None:
        """The motor law of this cycle.

        Raises:
            PacketError: no robot could follow it; the motors damp.
        """
        try:
            self._packet = self._encoder.packet(law)
        except PacketError:
            self._packet = None
            raise

    def advance(self) -> None:
        """Exchange; a cycle without a law damps. Whether there was an answer is `read`'s to say."""
        packet, self._packet = self._packet or self._encoder.damp, None
        self._exchange(packet)

    def truth(self) -> None:
        """None: nobody knows it."""

    def close(self) -> None:
        """Damp once more, and end; an emulator that got no more goes on with it."""
        if self._link.is_open:
            self._link.send(self._encoder.damp)
            self._link.close()

    def _exchange(self, packet: bytes) -> None:
        """Send until there is a new state, or nobody seems to be there."""
        until = monotonic() + self._settings.first_answer_s
        self._answered = False
        while not self._answered and monotonic() < until:
            sent = monotonic()
            self._link.send(packet)
            arrived = self._await_state(sent + _AGAIN_S)
            self._answered = arrived is not None
            self._recorder.command(sent, arrived, 0)

    def _await_state(self, deadline: float) -> float | None:
        while self._link.wait(deadline - monotonic()):
            arrived = monotonic()
            if self._feed.take(self._link.drain(), arrived):
                return arrived
            if arrived >= deadline:
                break
        return None
