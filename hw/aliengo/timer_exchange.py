"""A command every two milliseconds, on a thread of its own: how a real robot is spoken to."""

from __future__ import annotations

import atexit
from math import inf
from threading import Condition, Event, Thread
from time import monotonic, sleep

from surefoot.bus.topics import CYCLE_HZ
from surefoot.config.aliengo import Aliengo
from surefoot.hw.aliengo.complaint import complaint
from surefoot.hw.aliengo.deadlines import Deadlines
from surefoot.hw.aliengo.exchange import LAST_COMMANDS
from surefoot.hw.aliengo.link import Link
from surefoot.hw.aliengo.link_statistics import LinkRecorder
from surefoot.hw.aliengo.plausibility import Plausibility
from surefoot.hw.aliengo.state_feed import StateFeed, TimedState
from surefoot.hw.aliengo.tick_clock import TickClock
from surefoot.hw.errors import HardwareFault
from surefoot.hw.robot_interface import Sensors

_PERIOD_S = 1.0 / CYCLE_HZ
_PATIENCE_S = 10 * _PERIOD_S  # after a stall of this machine the robot answers again before it counts as silent


class TimerExchange:
    """Exchanges a command for a state at 500 Hz from construction to `close`.

    The robot speaks only when spoken to, and what it does when commands stop is not documented: so one is sent in
    every cycle. It is the newest order; an order older than `law_timeout_s` is replaced by the safe state.
    """

    def __init__(self, settings: Aliengo, plausibility: Plausibility, damp: bytes, recorder: LinkRecorder):
        """Open the link, damp, and wait for the first good state.

        Args:
            settings: of the link.
            plausibility: tells a state from garbage.
            damp: the command of the safe state.
            recorder: told how it goes.

        Raises:
            HardwareFault: there is no way to the robot, or it does not answer.
        """
        self._settings, self._damp, self._recorder = settings, damp, recorder
        self._order = (damp, inf)  # a packet, and until when it may be sent
        self._feed = StateFeed(settings, plausibility, recorder, TickClock(settings.tick_unit))
        self._news = Condition()
        self._ending = Event()
        self._link = Link(settings, recorder)
        self._thread = Thread(target=self._exchange, name="aliengo", daemon=True)
        self._thread.start()
        atexit.register(self.close)  # for a way out that closes nothing; only a kill leaves the robot to itself
        self._await_first_state()

    @property
    def newest(self) -> TimedState:
        with self._news:
            fresh = self._news.wait_for(self._fresh, _PATIENCE_S)
        if fresh is None:
            raise HardwareFault(self._complaint())
        return fresh

    def read(self) -> Sensors:
        return self.newest.sensors

    def order(self, packet: bytes | None) -> None:
        until = monotonic() + self._settings.law_timeout_s
        self._order = (self._damp, inf) if packet is None else (packet, until)

    def end_cycle(self) -> None:
        """Nothing: the thread's cycles are its own."""

    def close(self) -> None:
        """Damp, often enough for the robot to hear it, and end."""
        self._ending.set()
        self._thread.join()
        atexit.unregister(self.close)
        if self._link.is_open:
            for _ in range(LAST_COMMANDS):
                self._link.send(self._damp)
                sleep(_PERIOD_S)
            self._link.close()

    def _exchange(self) -> None:
        deadlines = Deadlines(_PERIOD_S, monotonic())
        while not self._ending.is_set():
            sent = monotonic()
            packet, until = self._order
            self._link.send(packet if sent <= until else self._damp)
            deadline, overruns = deadlines.following(monotonic())
            self._recorder.command(sent, self._listen(deadline), overruns)

    def _listen(self, deadline: float) -> float | None:
        """Take what comes until the next command is due; when the first new state came."""
        answered = None
        while self._link.wait(deadline - monotonic()):
            arrived = monotonic()
            if self._feed.take(self._link.drain(), arrived):
                answered = answered or arrived
                with self._news:
                    self._news.notify_all()
            if arrived >= deadline:
                break
        return answered

    def _fresh(self) -> TimedState | None:
        newest = self._feed.newest
        return newest if newest and monotonic() - newest.t <= self._settings.stale_s else None

    def _await_first_state(self) -> None:
        with self._news:
            came = self._news.wait_for(lambda: self._feed.newest, self._settings.first_answer_s)
        if came is None:
            self.close()
            raise HardwareFault(self._complaint())

    def _complaint(self) -> str:
        newest = self._feed.newest
        return complaint(
            self._settings, self._recorder.statistics(), None if newest is None else monotonic() - newest.t
        )
