"""The turn of one leg: what is known of it from PRE_OPT until it stands safely, or is back where it was."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import ClassVar

import numpy as np

from surefoot.bus.messages import FootholdRegions
from surefoot.components.fsm.motion import Region
from surefoot.components.memory import Memory


@dataclass
class LegTurn:
    """The leg under way and its foothold; after its turn the figures stand until the next one begins.

    Attributes:
        leg: whose turn it is; -1 nobody's.
        candidate: 0 the target, 1.. the alternatives.
        around: 0 the foothold, 1..4 the points around it, 5 back on it.
        targets_W: (4, 3) where each foot should stand; of this leg, the candidate of the moment [m].
        candidates_W: (n, 3) the target and its alternatives [m].
        failed_W: footholds (3,) that were tried in vain since the leg set out [m].
        answer: the map's, of this candidate.
        foothold_W: (3,) where the foot is to stand; where points around it are probed, where it does stand [m].
        support_pose: (6,) base pose inside the other three feet that reaches the foothold.
        envelope_W: (6, 3) what the stride needs of the foothold, by rising normal force [N].
        halt: why the robot is to stop once the leg is back, or "".
        no_way_back: why the leg in the air has no ground to go back to, or "".
    """

    memory: ClassVar[Memory] = Memory(
        "leg",
        "candidate",
        "around",
        "targets_W",
        "candidates_W",
        "failed_W",
        "foothold_W",
        "support_pose",
        "envelope_W",
        "halt",
        "no_way_back",
        answer=FootholdRegions,
    )

    leg: int = -1
    candidate: int = 0
    around: int = 0
    targets_W: np.ndarray = field(default_factory=lambda: np.zeros((4, 3)))
    candidates_W: np.ndarray = field(default_factory=lambda: np.zeros((0, 3)))
    failed_W: list[np.ndarray] = field(default_factory=list)
    answer: FootholdRegions = field(default_factory=FootholdRegions)
    foothold_W: np.ndarray = field(default_factory=lambda: np.zeros(3))
    support_pose: np.ndarray = field(default_factory=lambda: np.zeros(6))
    envelope_W: np.ndarray = field(default_factory=lambda: np.zeros((0, 3)))
    halt: str = ""
    no_way_back: str = ""

    def begin(self, leg: int, targets_W: np.ndarray, candidates_W: np.ndarray) -> None:
        """A leg's turn: targets (4, 3) of all feet and its own candidates (n, 3) [m]."""
        self.leg, self.candidate, self.around = leg, 0, 0
        self.targets_W, self.candidates_W = targets_W, candidates_W
        self.failed_W.clear()

    def end(self) -> None:
        """Nobody's turn: all four feet stand."""
        self.leg = -1
        self.rest()

    def rest(self) -> None:
        """The robot has come to rest, as it was to."""
        self.halt = self.no_way_back = ""

    @property
    def region(self) -> Region | None:
        """Where the map lets the foot touch down; None is the whole plane."""
        answer, leg = self.answer, self.leg
        return Region(answer.region_a[leg], answer.region_b[leg]) if answer.region_active[leg] else None

    def tried(self, foothold_W: np.ndarray, within_m: float) -> str:
        """Which foothold that was tried in vain a place (3,) is, nearer than `within_m` to it, or ""."""
        for failed_W in self.failed_W:
            apart = float(np.hypot(*(foothold_W - failed_W)[:2]))
            if apart < within_m:
                return f"{1e3 * apart:.0f} mm from a foothold tried in vain: not tried twice"
        return ""
