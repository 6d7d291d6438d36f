"""Time of a run on the monotonic clock: this machine's own beside io, io's as asked for from another machine."""

from __future__ import annotations

import time
from collections.abc import Callable
from math import isfinite
from threading import Event, Thread

import msgpack

from surefoot.bus.errors import BusError, MessageError
from surefoot.bus.service_keys import NOW
from surefoot.bus.session import Session
from surefoot.config.deployment import Deployment

_ASKS = 8  # the quickest answer of so many tells the time best
_ANSWER_S = 1.0
_ASK_AGAIN_S = 0.2
_PERIOD_S = 5.0
_DRIFT = 1e-4  # of two quartz clocks against each other, at the most


class AnotherRun(BusError):
    """The run that this process belongs to has ended, and another one has begun."""


class HubClock:
    """The run's time by io's clock, from another machine.

    Between two answers it goes on by this machine's clock, at the run's speed, also while the link is down, and it
    never goes back. It may be behind io's by as much as an answer took, and is never ahead: a message from the
    future would count as fresh for too long.

    Attributes:
        behind_s: how far it may be behind, at the last answer used.
    """

    def __init__(
        self, session: Session, ended: Callable[[], bool], drop: Callable[[str], None], speed: float = 1.0
    ):
        """Ask until there is an answer, or `ended()`; then again every few seconds.

        Args:
            session: the bus.
            ended: whether the process is to end.
            drop: told of an answer that cannot be read, and of a question that failed; it is asked again.
            speed: of the run, `run.speed`.
        """
        self._session, self._ended, self._drop, self._speed = session, ended, drop, speed
        self._run: float | None = None
        self._offset = self._measured = self._last = 0.0
        self.behind_s = float("inf")
        self._another = Event()
        while not self.ask() and not ended():
            time.sleep(_ASK_AGAIN_S)
        Thread(target=self._follow, daemon=True).start()

    def __call__(self) -> float:
        """Now [s].

        Raises:
            AnotherRun: io belongs to another run.
        """
        if self._another.is_set():
            raise AnotherRun(
                "the run has ended, and io's machine has begun another: start this machine's part again"
            )
        self._last = max(self._last, time.monotonic() * self._speed + self._offset)
        return self._last

    def ask(self) -> bool:
        """Ask io for its time; whether it has answered."""
        heard = False
        for _ in range(_ASKS):
            begun = time.monotonic()
            answers = self._session.ask(NOW, _ANSWER_S)
            ended = time.monotonic()
            if not answers:
                break
            try:
                run, t = _unpack(answers[0])
            except MessageError as error:
                self._drop(str(error))
                break
            if self._run not in (None, run):
                self._another.set()
            self._run, heard = run, True
            behind = ended - begun
            if behind < self.behind_s + _DRIFT * (begun - self._measured):
                self._offset, self._measured, self.behind_s = t - ended * self._speed, ended, behind
        return heard

    def _follow(self) -> None:
        while not (self._another.wait(_PERIOD_S) or self._ended()):
            try:
                self.ask()
            except Exception as error:  # without this thread the time would drift, and nobody would know
                self._drop(f"{NOW}: {error}")


def serve_time(session: Session, deployment: Deployment) -> None:
    """Tell the run's time to other machines; by the process of io."""
    epoch, now = deployment.run.epoch_s, _own_clock(deployment)
    session.serve(NOW, lambda: [msgpack.packb([epoch, now()])])


def run_clock(
    session: Session, deployment: Deployment, ended: Callable[[], bool], drop: Callable[[str], None]
) -> Callable[[], float]:
    """The run's time [s] on the monotonic clock, in this process; `ended` and `drop` as of `HubClock`."""
    if deployment.run.clock == "monotonic" and not deployment.network.at_hub:
        return HubClock(session, ended, drop, deployment.run.speed)
    return _own_clock(deployment)


def _own_clock(deployment: Deployment) -> Callable[[], float]:
    """The run's time [s] on the machine of io."""
    epoch, speed = deployment.run.epoch_s, deployment.run.speed
    return lambda: (time.monotonic() - epoch) * speed


def _unpack(payload: bytes) -> tuple[float, float]:
    """When the run began on io's clock, which tells runs apart, and its time [s].

    Raises:
        MessageError: it is none.
    """
    try:
        run, t = map(float, msgpack.unpackb(payload))
    except Exception as error:
        raise MessageError(f"{NOW}: no time of a run ({type(error).__name__}: {error})") from None
    if not (isfinite(run) and isfinite(t)):
        raise MessageError(f"{NOW}: no time of a run ({run}, {t})")
    return run, t
