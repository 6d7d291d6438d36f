"""A walk of the emulated robot, graded by what truly happened to it."""

from __future__ import annotations

from collections import Counter
from collections.abc import Callable
from contextlib import closing
from dataclasses import dataclass
from time import perf_counter

from surefoot.bus.message import Message
from surefoot.bus.messages import FsmEvent, MotionReference
from surefoot.config.deployment import Deployment
from surefoot.hw.aliengo.link_statistics import LinkStatistics
from surefoot.hw.emulator.witness import Witness
from surefoot.hw.errors import HardwareFault
from surefoot.tools.emulated_stack import EmulatedStack

_TOLD_S = 10.0

Say = Callable[[str], None]


@dataclass(frozen=True)
class Walk:
    """How a walk went.

    Attributes:
        witness: what truly happened.
        finished: the state machine says that the goal is reached.
        fault: of the hardware, in words; empty without one.
        counts: of the state machine's events, by kind.
        link: as the driver saw it.
        t: simulated time at the end [s].
        real_time_factor: simulated by wall time.
    """

    witness: Witness
    finished: bool
    fault: str
    counts: Counter[str]
    link: LinkStatistics
    t: float
    real_time_factor: float

    @property
    def sound(self) -> bool:
        """It got up and has not fallen, and the stack never lost the robot."""
        return self.witness.stood_t is not None and not self.witness.fell and not self.fault

    def __str__(self) -> str:
        counts, found = self.counts, self.link
        collapses = counts["collapse"] + counts["late_collapse"]
        lines = [
            str(self.witness),
            f"{self.t:.1f} s, real-time factor {self.real_time_factor:.2f}, {counts['accepted']} footholds, "
            f"{collapses} collapses{', goal reached' if self.finished else ''}",
            f"link: {found.commands} commands, {100 * found.loss:.1f} % of the last ones without a new state",
        ]
        return "\n".join(lines + ([f"fault: {self.fault}"] if self.fault else []))


def walk(deployment: Deployment, seconds: float, say: Say = lambda words: None) -> Walk:
    """Let it get up and go, until the goal is reached, the robot has fallen or is lost, or the time is over.

    Args:
        deployment: of an emulated robot in simulated time; `run.command` is given at once.
        seconds: of simulated time at the most.
        say: told now and then, in a line, how it goes.
    """
    with closing(EmulatedStack(deployment)) as stack:
        watch, begun, told, fault = _Watch(), perf_counter(), 0.0, ""
        witness = stack.robot.witness
        stack.listen(watch)

        def over() -> bool:
            nonlocal told
            if stack.t - told >= _TOLD_S:
                told = stack.t
                say(f"{stack.t:.0f} s, {watch.state}, {watch.counts['accepted']} footholds; {witness}")
            return bool(witness.fell) or watch.finished

        stack.command(deployment.run.command)
        try:
            stack.run(seconds, over)
        except HardwareFault as error:
            fault = str(error)
        factor = stack.t / (perf_counter() - begun)
        return Walk(witness, watch.finished, fault, watch.counts, stack.driver.statistics, stack.t, factor)


class _Watch:
    """Listens to the state machine."""

    def __init__(self) -> None:
        self.counts: Counter[str] = Counter()
        self.state = ""
        self.finished = False

    def __call__(self, key: str, message: Message) -> None:
        if isinstance(message, FsmEvent):
            self.counts[message.kind] += 1
        elif isinstance(message, MotionReference):
            self.state, self.finished = message.state, message.finished
