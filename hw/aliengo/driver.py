"""The real Aliengo behind the robot interface."""

from __future__ import annotations

import atexit
from math import inf
from threading import Condition, Event, Thread
from time import monotonic, sleep

from surefoot.bus.topics import CYCLE_HZ
from surefoot.config.aliengo import Aliengo
from surefoot.config.robot import Robot
from surefoot.hw.aliengo.complaint import complaint
from surefoot.hw.aliengo.deadlines import Deadlines
from surefoot.hw.aliengo.law_encoder import LawEncoder
from surefoot.hw.aliengo.link import Link
from surefoot.hw.aliengo.link_statistics import LinkRecorder, LinkStatistics
from surefoot.hw.aliengo.plausibility import Plausibility
from surefoot.hw.aliengo.state_feed import StateFeed, TimedState
from surefoot.hw.errors import HardwareFault, PacketError
from surefoot.hw.robot_interface import DepthImage, MotorLaw, Sensors

_PERIOD_S = 1.0 / CYCLE_HZ
_PATIENCE_S = 10 * _PERIOD_S  # after a stall of this machine the robot answers again before it counts as silent
_LAST_COMMANDS = 25  # that damp, when the driver closes: one may get lost, and the robot may hold the last it got


class AliengoDriver:
    """Exchanges a command for a state at 500 Hz on a thread of its own, from construction to `close`.

    The robot speaks only when spoken to, and what it does when commands stop is not documented: so one is sent in
    every cycle. It is the newest motor law; it damps when the last cycle of the caller brought no law, when the
    law is older than `law_timeout_s`, and at the end.
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
        self._settings = settings
        plausibility = Plausibility(robot, settings.plausible)
        self._encoder = LawEncoder(settings, plausibility, damping_kd)
        self._damp = self._encoder.damp
        self._order = (self._damp, inf)  # a packet, and until when it may be sent
        self._written = False
        self._recorder = LinkRecorder()
        self._feed = StateFeed(settings, plausibility, self._recorder)
        self._news = Condition()
        self._ending = Event()
        self._link = Link(settings, self._recorder)
        self._thread = Thread(target=self._exchange, name="aliengo", daemon=True)
        self._thread.start()
        atexit.register(self.close)  # for a way out that closes nothing; only a kill leaves the robot to itself
        self._await_first_state()

    @property
    def newest(self) -> TimedState:
        """All that the robot told in its newest state, and when that was.

        Raises:
            HardwareFault: it is older than `stale_s`.
        """
        with self._news:
            fresh = self._news.wait_for(self._fresh, _PATIENCE_S)
        if fresh is None:
            raise HardwareFault(self._complaint())
        return fresh

    @property
    def statistics(self) -> LinkStatistics:
        """How well the exchange goes."""
        return self._recorder.statistics()

    @property
    def tick_unit(self) -> str:
        """As of `TickClock`: "us", "ms", "none", or "" while it is being found out."""
        return self._feed.clock.unit

    @property
    def trouble(self) -> str:
        """What of the last law did not fit the packet; what was last amiss on the link."""
        return "; ".join(words for words in (*self._encoder.limited, self._recorder.trouble) if words)

    def read(self) -> Sensors:
        return self.newest.sensors

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
            self._order = (self._damp, inf)
            raise
        self._order = (packet, monotonic() + self._settings.law_timeout_s)
        self._written = True

    def advance(self) -> None:
        """End the cycle without waiting; one without a law damps."""
        if not self._written:
            self._order = (self._damp, inf)
        self._written = False

    def truth(self) -> None:
        """None: nobody knows it."""

    def close(self) -> None:
        """Damp, often enough for the robot to hear it, and end."""
        self._ending.set()
        self._thread.join()
        atexit.unregister(self.close)
        if self._link.is_open:
            for _ in range(_LAST_COMMANDS):
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
        return complaint(self._settings, self.statistics, None if newest is None else monotonic() - newest.t)
