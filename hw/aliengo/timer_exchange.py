"""Commands and states with a thread that keeps time: how a real robot is spoken to."""

from __future__ import annotations

import atexit
from math import inf
from threading import Condition, Event, Lock, Thread
from time import monotonic, sleep

from surefoot.bus.topics import CYCLE_HZ
from surefoot.config.aliengo import Aliengo
from surefoot.hw.aliengo.complaint import complaint
from surefoot.hw.aliengo.exchange import LAST_COMMANDS
from surefoot.hw.aliengo.link import Link
from surefoot.hw.aliengo.link_statistics import LinkRecorder
from surefoot.hw.aliengo.pace import Pace
from surefoot.hw.aliengo.plausibility import Plausibility
from surefoot.hw.aliengo.state_feed import StateFeed, TimedState
from surefoot.hw.aliengo.tick_clock import TickClock
from surefoot.hw.errors import HardwareFault
from surefoot.hw.robot_interface import Sensors

_PERIOD_S = 1.0 / CYCLE_HZ
_PATIENCE_S = 10 * _PERIOD_S  # after a stall of this machine the robot answers again before it counts as silent


class TimerExchange:
    """Exchanges a command for a state at 500 Hz from construction to `close`.

    An order leaves at once, from the caller's own thread. The robot speaks only when spoken to, and what it does
    when commands stop is not documented: so where no order comes the thread here sends the newest again. One that
    is older than `law_timeout_s` is replaced by the safe state.
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
        self._pace = Pace(_PERIOD_S, settings.gap_s, monotonic())
        self._sent, self._overruns = inf, 0  # of the last command
        self._answered: float | None = None
        self._sending = Lock()  # of all that is told of commands: two threads send
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
        with self._sending:
            now = monotonic()
            until = now + self._settings.law_timeout_s
            self._order = (self._damp, inf) if packet is None else (packet, until)
            if self._pace.order(now) and not self._ending.is_set():
                self._send(now)

    def end_cycle(self) -> None:
        """Nothing: the robot's cycles are the pace's."""

    def close(self) -> None:
        """Damp, often enough for the robot to hear it, and end."""
        self._ending.set()
        self._thread.join()
        atexit.unregister(self.close)
        if self._link.is_open:
            with self._sending:
                self._note_last()
            for _ in range(LAST_COMMANDS):
                self._link.send(self._damp)
                sleep(_PERIOD_S)
            self._link.close()

    def _exchange(self) -> None:
        while not self._ending.is_set():
            if self._link.wait(self._pace.look(monotonic()) - monotonic()):
                self._listen(monotonic())
            with self._sending:
                now = monotonic()
                if now >= self._pace.due:
                    self._send(now)

    def _send(self, now: float) -> None:
        """The order, unless it is too old; whoever calls this holds `_sending`."""
        packet, until = self._order
        self._link.send(packet if now <= until else self._damp)
        self._note_last()
        self._sent, self._answered, self._overruns = now, None, self._pace.left(now)

    def _note_last(self) -> None:
        """The answer to a command may come until the next one leaves."""
        if self._sent < inf:
            self._recorder.command(self._sent, self._answered, self._overruns)

    def _listen(self, arrived: float) -> None:
        """Take what has come by a time [s]."""
        if not self._feed.take(self._link.drain(), arrived):
            return
        with self._sending:
            if self._answered is None and arrived >= self._sent:
                self._answered = arrived
        with self._news:
            self._news.notify_all()

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
