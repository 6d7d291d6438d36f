"""The newest state that the robot told of."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass

from surefoot.config.aliengo import Aliengo
from surefoot.hw.aliengo.aliengo_state import AliengoState
from surefoot.hw.aliengo.generation import GENERATIONS
from surefoot.hw.aliengo.link_statistics import LinkRecorder
from surefoot.hw.aliengo.plausibility import Plausibility
from surefoot.hw.aliengo.remote import StopChords
from surefoot.hw.aliengo.state_packet import decode_state
from surefoot.hw.aliengo.tick_clock import TickClock
from surefoot.hw.errors import PacketError
from surefoot.hw.robot_interface import Sensors, Stop


@dataclass(frozen=True)
class TimedState:
    """A state, when it was measured (on the clock on which states arrive [s]), and what the remote asks for."""

    t: float
    state: AliengoState
    stop: Stop = ""

    @property
    def sensors(self) -> Sensors:
        """What of it every robot has."""
        state = self.state
        return Sensors(
            q=state.q,
            dq=state.dq,
            tau=state.tau,
            omega_WB_B=state.omega_WB_B,
            acc_B=state.acc_B,
            t=self.t,
            stop=self.stop,
            temperature=state.temperature,
            foot_force=state.foot_force,
        )


class StateFeed:
    """Takes datagrams, keeps the newest good state; what is damaged, a repeat or out of order is counted only.

    Attributes:
        newest: None before there is one.
        clock: of the robot's tick.
    """

    def __init__(self, settings: Aliengo, plausibility: Plausibility, recorder: LinkRecorder, clock: TickClock):
        self._generation = GENERATIONS[settings.generation]
        self._reading, self._plausibility, self._recorder = settings.reading, plausibility, recorder
        self._chords = StopChords(settings.chords)
        self.clock = clock
        self.newest: TimedState | None = None

    def take(self, packets: Iterable[bytes], arrived: float) -> bool:
        """Look at what came.

        Args:
            packets: in order of arrival.
            arrived: when [s].

        Returns:
            Whether there is a newer state.
        """
        new = duplicates = old = 0
        for packet in packets:
            try:
                state = decode_state(packet, self._generation, self._reading, self._plausibility)
            except PacketError as error:
                self._recorder.refuse(error)
                continue
            ahead = self.clock.ahead(state.tick)
            if ahead > 0:
                t, stop = self.clock.follow(state.tick, arrived), self._chords.held(state.remote)
                self.newest = TimedState(t, state, stop)
                new += 1
            elif ahead == 0:
                duplicates += 1
            else:
                old += 1
        self._recorder.states(new, duplicates, old)
        return new > 0
