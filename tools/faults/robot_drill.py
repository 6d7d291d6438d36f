"""Breaks an emulated robot or its link, standing and in a swing, and measures what comes of it in cycles."""

from __future__ import annotations

from collections.abc import Sequence
from contextlib import closing
from dataclasses import dataclass, replace
from pathlib import Path

from surefoot.bus.message import Message
from surefoot.bus.messages import HardwareState, LegStatus, MotionReference
from surefoot.bus.topics import CYCLE_HZ
from surefoot.components.component import Inbox, Outbox
from surefoot.config.deployment import load_deployment
from surefoot.hw.errors import HardwareFault
from surefoot.tools.emulated_stack import EmulatedStack
from surefoot.tools.faults.robot_fault import Declared, RobotFault, damped_within_cycles

PHASES = {"standing": "stand", "swing": "forward"}
"""And the command that leads to each."""

AFTER_S = 1.5
"""For so long what comes of a fault is watched [s]."""

_STANDS_S = 2.2  # it lies at first, and has stood up by 1.8 s
_INTO_S = 0.1  # a swing takes 0.5 s
_LIMIT_S = 10.0


@dataclass(frozen=True)
class RobotResult:
    """What came of a fault.

    Attributes:
        fault, phase: what was done when.
        good: as it is declared; true where nothing is.
        damped_after: cycles from its begin, or from when it counts, until no motor was driven any more; None if
            one still is.
        outcome: of the robot, in words.
        told: what was said of it first.
    """

    fault: RobotFault
    phase: str
    good: bool
    damped_after: int | None
    outcome: str
    told: str


class RobotDrill:
    """Faults of one deployment of an emulated robot in simulated time; each has a run of its own."""

    def __init__(self, config: Path, settings: Sequence[str] = ()):
        flat = ["terrain.kind=flat", "hw.aliengo.tick_unit=us"]
        self._deployment = load_deployment(config, [*flat, *settings])
        self._begin: dict[str, float] = {"standing": _STANDS_S}

    def limit_cycles(self, fault: RobotFault) -> int | None:
        """Within which no motor may be driven any more; None where that is not declared."""
        return damped_within_cycles(self._deployment, fault.declared)

    def carry_out(self, fault: RobotFault, phase: str) -> RobotResult:
        """Break it in a phase of `PHASES`."""
        begin = self._begins(phase)
        broken = replace(self._deployment, emulator=fault.broken(self._deployment.emulator, begin))
        with closing(EmulatedStack(broken)) as stack:
            ear = _Ear(begin)
            stack.listen(ear)
            stack.command(PHASES[phase])
            counts, ended = _Counts(fault, stack, begin), False
            try:
                stack.run(begin + AFTER_S, counts)
            except HardwareFault as error:
                ended = True
                ear.told = ear.told or f"io: {error}"
                self._let_go(stack)
                while stack.robot.t < begin + AFTER_S:  # nobody speaks to it any more
                    stack.robot.advance()
            witness = stack.robot.witness
            since = witness.damped_t
            damped_after = None if since is None else max(round((since - counts.t) * CYCLE_HZ), 0)
            outcome = witness.fell or "upright"
        return RobotResult(
            fault, phase, self._good(fault, ended, damped_after, witness.fell), damped_after, outcome, ear.told
        )

    def _good(self, fault: RobotFault, ended: bool, damped_after: int | None, fell: str) -> bool:
        if fault.declared is Declared.GOES_ON:
            return damped_after is None and not fell
        if fault.declared is Declared.UNHEARD:
            return ended
        if fault.declared in (Declared.DAMPED_MOTOR, Declared.DAMPED_ENCODER):
            return not fell and (damped_after is not None or fault.declared is Declared.DAMPED_ENCODER)
        limit = self.limit_cycles(fault)
        return limit is not None and damped_after is not None and damped_after <= limit

    @staticmethod
    def _let_go(stack: EmulatedStack) -> None:
        """As the process of io does when a step has failed: damp, in the cycles that a closing driver takes."""
        io = stack.io
        io.deactivate(stack.t, Inbox(io.inputs), Outbox(io.outputs, lambda key, message: None))

    def _begins(self, phase: str) -> float:
        """When a run without a fault is in the phase [s]."""
        if phase not in self._begin:
            with closing(EmulatedStack(self._deployment)) as stack:
                ear = _Ear(0.0)
                stack.listen(ear)
                stack.command(PHASES[phase])
                stack.run(_LIMIT_S, lambda: ear.swings)
                self._begin[phase] = stack.t + _INTO_S
        return self._begin[phase]


class _Counts:
    """Notes from when on a fault counts; looked at between two instants."""

    def __init__(self, fault: RobotFault, stack: EmulatedStack, begin: float):
        self.t = begin
        self._fault, self._stack, self._seen = fault, stack, False

    def __call__(self) -> bool:
        robot, gate = self._stack.robot, self._stack.io.deployment.hw.gate
        if not self._seen and robot.t >= self.t:
            self._seen = self._fault.counts(robot.plant.truth(), gate)
            self.t = robot.t
        return False


class _Ear:
    """What is said from a time on: why the gate damps, why the state machine stops."""

    def __init__(self, begin: float):
        self.told, self.swings, self._begin = "", False, begin
        self._before = ""

    def __call__(self, key: str, message: Message) -> None:
        if isinstance(message, MotionReference):
            self.swings = bool((message.leg_status == LegStatus.SWING).any())
            calm = message.state not in ("DAMP", "STOPPED")
            if not calm and message.t >= self._begin and message.reason != self._before:
                self.told = self.told or f"fsm: {message.reason}"
            self._before = message.reason
        elif isinstance(message, HardwareState) and message.damping and message.t >= self._begin:
            self.told = self.told or f"gate: {message.gate}"
