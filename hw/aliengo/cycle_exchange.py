"""A command and what comes of it in each cycle of the caller, with an emulator whose time waits."""

from __future__ import annotations

from dataclasses import replace
from time import monotonic, monotonic_ns

from surefoot.bus.topics import CYCLE_HZ
from surefoot.config.aliengo import Aliengo
from surefoot.hw.aliengo.complaint import complaint, no_answer
from surefoot.hw.aliengo.exchange import LAST_COMMANDS
from surefoot.hw.aliengo.link import Link
from surefoot.hw.aliengo.link_statistics import LinkRecorder
from surefoot.hw.aliengo.plausibility import Plausibility
from surefoot.hw.aliengo.state_feed import StateFeed, TimedState
from surefoot.hw.aliengo.tick_clock import TickClock
from surefoot.hw.aliengo.turn import Turn, decode_turn, encode_turn
from surefoot.hw.errors import HardwareFault
from surefoot.hw.robot_interface import Sensors

_AGAIN_S = 0.05
"""After which a turn is sent again: it may have got lost; if not, the emulator knows it by its number."""


class CycleExchange:
    """Takes a turn with an emulator in each cycle of the caller, which waits for it.

    The emulator's time goes on by a cycle with each turn, so that simulated time may wait and a slow machine
    changes nothing. What the emulated link loses, damages or delays happens to the packets within the turns: a
    cycle may bring no state, or an old one, and then the newest is older than before.

    Times here are simulated ones, cycles since the first turn. As with a real robot the quickest state so far
    counts as one that took no time: of a delay only what varies shows in the age of a reading.
    """

    def __init__(self, settings: Aliengo, plausibility: Plausibility, damp: bytes, recorder: LinkRecorder):
        """Open the link, and damp until the first good state.

        Args:
            settings: of the link.
            plausibility: tells a state from garbage.
            damp: the command of the safe state.
            recorder: told how it goes.

        Raises:
            HardwareFault: nobody answers, or no good state comes.
        """
        self._settings, self._damp, self._recorder = settings, damp, recorder
        self._order = damp
        self._feed = StateFeed(settings, plausibility, recorder, TickClock(settings.tick_unit, drift=0.0))
        self._link = Link(settings, recorder)
        self._first = monotonic_ns()  # higher than any number of an earlier driver on this machine
        self._cycles = 0
        self._answered = True
        while self._feed.newest is None and self._answered and self._t < settings.first_answer_s:
            self.end_cycle()
        if self._feed.newest is None:
            fault = self._fault()
            self.close()
            raise fault

    @property
    def newest(self) -> TimedState:
        newest = self._feed.newest
        if not self._answered or newest is None or self._age_s(newest) > self._settings.stale_s:
            raise self._fault()
        return newest

    def read(self) -> Sensors:
        newest = self.newest
        return replace(newest.sensors, t=None, age_s=self._age_s(newest))

    def order(self, packet: bytes | None) -> None:
        self._order = packet or self._damp

    def end_cycle(self) -> None:
        """Take a turn: until it is answered, or nobody seems to be there."""
        self._cycles += 1
        number = self._first + self._cycles
        turn = encode_turn(Turn(number, (self._order,)))
        begun, answer = monotonic(), None
        until = begun + self._settings.first_answer_s
        while answer is None and monotonic() < until:
            self._link.send(turn)
            answer = self._await(number, monotonic() + _AGAIN_S)
        self._answered = answer is not None
        new = answer is not None and self._feed.take(answer.packets, self._t)
        self._recorder.command(begun, monotonic() if new else None, 0)

    def close(self) -> None:
        """Damp, often enough for the robot to hear it on the worst of links, and end."""
        if self._link.is_open:
            self.order(None)
            for _ in range(LAST_COMMANDS * self._answered):
                self.end_cycle()
                if not self._answered:
                    break
            self._link.close()

    @property
    def _t(self) -> float:
        return self._cycles / CYCLE_HZ

    def _age_s(self, state: TimedState) -> float:
        """In whole cycles: the robot measures in each, and reading is between two."""
        return round((self._t - state.t) * CYCLE_HZ) / CYCLE_HZ

    def _await(self, number: int, deadline: float) -> Turn | None:
        while self._link.wait(deadline - monotonic()):
            for datagram in self._link.drain():
                answer = decode_turn(datagram)
                if answer is not None and answer.number == number:
                    return answer
            if monotonic() >= deadline:
                break
        return None

    def _fault(self) -> HardwareFault:
        newest, found = self._feed.newest, self._recorder.statistics()
        if not self._answered:
            return HardwareFault(no_answer(self._settings, found))
        return HardwareFault(complaint(self._settings, found, None if newest is None else self._age_s(newest)))
