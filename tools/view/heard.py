"""What is known of a run at one instant."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import Any

from surefoot.bus.messages import (
    ElevationGrid,
    HardwareState,
    JointCommand,
    MotionReference,
    Policy,
    SimTruth,
    StateEstimate,
)
from surefoot.tools.view.history import History

STREAMS = {
    "hardware": "hw/state",
    "estimate": "state/estimate",
    "reference": "fsm/reference",
    "command": "joint/command",
    "policy": "mpc/policy",
    "grid": "map/elevation",
    "truth": "sim/truth",
}
"""Of each only the newest message counts."""


@dataclass
class Heard:
    """The newest message of each stream, or None, and what the rare ones have told so far."""

    hardware: HardwareState | None = None
    estimate: StateEstimate | None = None
    reference: MotionReference | None = None
    command: JointCommand | None = None
    policy: Policy | None = None
    grid: ElevationGrid | None = None
    truth: SimTruth | None = None
    history: History = field(default_factory=History)

    def note(self, name: str, message: Any) -> None:
        """Take in the newest message of a stream, by its name in `STREAMS`."""
        setattr(self, name, message)

    @property
    def t(self) -> float:
        """The run's time [s]."""
        stream = self.estimate or self.reference or self.hardware
        return stream.t if stream is not None else 0.0
