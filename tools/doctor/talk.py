"""A talk with the robot in which nothing moves: zero gains until it answers, then damping."""

from __future__ import annotations

from collections import Counter
from dataclasses import dataclass, field, replace
from time import monotonic

import numpy as np

from surefoot.bus.topics import CYCLE_HZ
from surefoot.config.aliengo import Aliengo
from surefoot.config.deployment import Deployment
from surefoot.hw.aliengo.aliengo_state import AliengoState
from surefoot.hw.aliengo.command_packet import encode_command
from surefoot.hw.aliengo.deadlines import Deadlines
from surefoot.hw.aliengo.exchange import LAST_COMMANDS
from surefoot.hw.aliengo.generation import BY_LENGTH, GENERATIONS
from surefoot.hw.aliengo.law_encoder import LawEncoder
from surefoot.hw.aliengo.link import Link
from surefoot.hw.aliengo.link_statistics import LinkRecorder, LinkStatistics
from surefoot.hw.aliengo.plausibility import Plausibility
from surefoot.hw.aliengo.state_feed import StateFeed
from surefoot.hw.aliengo.tick_clock import TickClock
from surefoot.hw.robot_interface import damping_law

_PERIOD_S = 1.0 / CYCLE_HZ


@dataclass
class Heard:
    """What came in one talk.

    Attributes:
        asked: generation of the commands.
        lengths: how many datagrams of each length.
        states: the good ones with a new tick, oldest first.
        arrived: when each came, on the monotonic clock [s].
        remote: (40,) bytes of the newest state's remote.
        statistics: of the exchange while it damped; None: it never came to that.
        trouble: what was last amiss with a packet or the socket.
    """

    asked: str
    lengths: Counter[int] = field(default_factory=Counter)
    states: list[AliengoState] = field(default_factory=list)
    arrived: list[float] = field(default_factory=list)
    remote: np.ndarray = field(default_factory=lambda: np.zeros(40, np.uint8))
    statistics: LinkStatistics | None = None
    trouble: str = ""

    @property
    def generations(self) -> tuple[str, ...]:
        """Of what came, by its length."""
        return tuple(sorted({BY_LENGTH[length][0].name for length in self.lengths if length in BY_LENGTH}))


def talk(deployment: Deployment) -> Heard:
    """Ask in the deployment's generation; if nothing comes, in the other one.

    Raises:
        HardwareFault: the local port is taken, or there is no way to the robot.
    """
    wire = deployment.hw.aliengo
    heard = _talk_in(deployment, wire)
    for name in GENERATIONS:
        if not heard.lengths and name != wire.generation:
            other = _talk_in(deployment, replace(wire, generation=name))  # type: ignore[arg-type]
            heard = other if other.lengths else heard
    return heard


def _talk_in(deployment: Deployment, wire: Aliengo) -> Heard:
    plausibility = Plausibility(deployment.load_robot(), wire.plausible)
    no_gains = encode_command(damping_law(0.0), GENERATIONS[wire.generation], plausibility)[0]
    damp = LawEncoder(wire, plausibility, deployment.hw.damping_kd).damp
    with _Ear(wire, plausibility) as ear:
        ear.exchange(no_gains, wire.first_answer_s, until_heard=True)
    if not ear.heard.states:
        return ear.heard
    with _Ear(wire, plausibility) as ear:
        ear.exchange(damp, deployment.doctor.watch_s)
        ear.heard.statistics = ear.recorder.statistics()
        ear.exchange(damp, LAST_COMMANDS * _PERIOD_S)
    return ear.heard


class _Ear:
    """One socket, and all that is heard on it.

    Attributes:
        heard: so far.
        recorder: as the driver has it.
    """

    def __init__(self, wire: Aliengo, plausibility: Plausibility):
        self._sent = 0
        self._waits = wire.exchange == "cycle"
        self._layout = GENERATIONS[wire.generation].state
        self.heard, self.recorder = Heard(wire.generation), LinkRecorder()
        self._feed = StateFeed(wire, plausibility, self.recorder, TickClock(wire.tick_unit))
        self._link = Link(wire, self.recorder)

    def __enter__(self) -> _Ear:
        return self

    def __exit__(self, *_: object) -> None:
        self.heard.trouble = self.recorder.statistics().trouble
        self._link.close()

    def exchange(self, packet: bytes, seconds: float, until_heard: bool = False) -> None:
        """Send a packet in every cycle, for so long, or until it is clear who answers.

        With an emulator whose time waits it is so long by the robot's time.
        """
        deadlines, end = Deadlines(_PERIOD_S, monotonic()), monotonic() + seconds
        least = self._sent + round(seconds / _PERIOD_S) if self._waits and not until_heard else 0
        while (sent := monotonic()) < end or self._sent < least:
            self._link.send(packet)
            self._sent += 1
            deadline, overruns = deadlines.following(monotonic())
            self.recorder.command(sent, self._listen(deadline), overruns)
            if until_heard and (self.heard.states or set(self.heard.generations) - {self.heard.asked}):
                break

    def _listen(self, deadline: float) -> float | None:
        answered = None
        while self._link.wait(deadline - monotonic()):
            arrived = monotonic()
            for packet in self._link.drain():
                if self._take(packet, arrived):
                    answered = answered or arrived
            if arrived >= deadline:
                break
        return answered

    def _take(self, packet: bytes, arrived: float) -> bool:
        self.heard.lengths[len(packet)] += 1
        if not self._feed.take([packet], arrived) or self._feed.newest is None:
            return False
        self.heard.states.append(self._feed.newest.state)
        self.heard.arrived.append(arrived)
        self.heard.remote = np.frombuffer(packet, self._layout.dtype)[0]["remote"]
        return True
