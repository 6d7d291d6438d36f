"""How well the exchange with the robot goes."""

from __future__ import annotations

from collections import Counter, deque
from dataclasses import dataclass, fields
from statistics import median
from threading import Lock

from surefoot.bus.topics import CYCLE_HZ, TOLD_S
from surefoot.hw.errors import Flaw, PacketError

_WINDOW = 500
_TOLD = round(TOLD_S * CYCLE_HZ)  # cycles


@dataclass(frozen=True)
class LinkStatistics:
    """Counts since the start; rate, loss and latency over the last 500 commands.

    An answer does not say which command it answers. It is taken for that of the command before it, so that a robot
    which needs longer than a cycle seems quicker than it is.
    """

    commands: int
    states: int  # with a tick ahead of all before
    duplicates: int  # with the newest tick again
    old: int  # with an earlier one
    checksum_errors: int
    refused: int  # of a wrong length or level, or with a figure that no robot measures
    socket_errors: int  # nobody listens at the robot's port, or the cable is out
    overruns: int  # cycles that were left out because this machine was late
    rate_hz: float  # of commands that were answered by a new state; 0 before there are two
    loss: float  # share of commands that were not
    latency_ms: float  # from a command to its answer, median; 0 before there is one
    latency_max_ms: float
    trouble: str  # what was last amiss in a packet or with the socket; empty when nothing ever was


_COUNTED = [each.name for each in fields(LinkStatistics) if each.type == "int"]


class LinkRecorder:
    """Filled by the thread that exchanges; any thread may ask for the statistics."""

    def __init__(self) -> None:
        self._lock = Lock()
        self._counts = Counter(dict.fromkeys(_COUNTED, 0))
        self._answers: deque[tuple[float, float] | None] = deque(maxlen=_WINDOW)  # arrival, latency [s]
        self._trouble, self._troubled = "", 0  # in words, and in which cycle

    def states(self, new: int, duplicates: int, old: int) -> None:
        """States came that could be read."""
        with self._lock:
            self._counts.update(states=new, duplicates=duplicates, old=old)

    def refuse(self, error: PacketError) -> None:
        """A packet came that could not."""
        with self._lock:
            self._counts["checksum_errors" if error.flaw == Flaw.CHECKSUM else "refused"] += 1
            self._note(str(error))

    def socket_error(self, said: str) -> None:
        """The socket complains."""
        with self._lock:
            self._counts["socket_errors"] += 1
            self._note(said)

    def command(self, sent: float, answered: float | None, overruns: int) -> None:
        """One cycle is over.

        Args:
            sent: when its command left [s].
            answered: when the first new state after it came [s]; None without one.
            overruns: cycles to be left out now.
        """
        with self._lock:
            self._counts.update(commands=1, overruns=overruns)
            self._answers.append(None if answered is None else (answered, answered - sent))

    @property
    def trouble(self) -> str:
        """What was last amiss in a packet or with the socket; empty when nothing was in the last seconds."""
        with self._lock:
            return self._trouble if self._cycles - self._troubled < _TOLD else ""

    def statistics(self) -> LinkStatistics:
        with self._lock:
            counts, answers, trouble = dict(self._counts), list(self._answers), self._trouble
        came = [answer for answer in answers if answer]
        latencies = [1e3 * latency for _, latency in came]
        duration = came[-1][0] - came[0][0] if came else 0.0
        return LinkStatistics(
            **counts,
            rate_hz=(len(came) - 1) / duration if duration else 0.0,
            loss=1.0 - len(came) / len(answers) if answers else 0.0,
            latency_ms=median(latencies) if latencies else 0.0,
            latency_max_ms=max(latencies, default=0.0),
            trouble=trouble,
        )

    @property
    def _cycles(self) -> int:
        return self._counts["commands"] + self._counts["overruns"]

    def _note(self, trouble: str) -> None:
        """Whoever calls this holds the lock."""
        self._trouble, self._troubled = trouble, self._cycles
