"""One press of the ground: the forces of the envelope, and what was really held of them."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from surefoot.components.memory import Memory
from surefoot.config.fsm import Fsm

_HELD_WINDOW_S = 0.06  # a force is held if its mean over the end of its dwell is


def peak_n(forces_W: np.ndarray, normal_W: np.ndarray) -> float:
    """Largest normal component of forces (n, 3) along a unit normal (3,) [N]; 0 without any."""
    return float((forces_W @ normal_W).max(initial=0.0))


@dataclass(frozen=True)
class Held:
    """One force of the envelope when its dwell is over.

    Attributes:
        index: 0..5.
        asked_n, held_n: along the surface normal [N].
        enough: whether it counts as held.
    """

    index: int
    asked_n: float
    held_n: float
    enough: bool


class Probe:
    """The six forces of an envelope, one dwell each.

    Attributes:
        asked_W: (6, 3) what the foot is asked to press with: the envelope, as far as statics allow [N].
        told: how many forces are over.
        held_n: the largest normal force held so far [N].
    """

    memory = Memory("asked_W", "told", "held_n", "_t0", "_pressed")

    def __init__(self, settings: Fsm):
        self._settings = settings
        self.asked_W = np.zeros((0, 3))
        self.told = 0
        self.held_n = 0.0
        self._t0 = 0.0
        self._pressed: list[tuple[float, float]] = []

    @property
    def over(self) -> bool:
        """Every force has had its dwell."""
        return self.told == len(self.asked_W)

    @property
    def duration_s(self) -> float:
        """All dwells together."""
        return len(self.asked_W) * self._settings.dwell_s

    def short(self, normal_W: np.ndarray) -> bool:
        """The largest force held is too small a share of the largest asked."""
        return self.held_n < self._settings.held_share * peak_n(self.asked_W, normal_W)

    def ask(self, envelope_W: np.ndarray, most_n: float, normal_W: np.ndarray) -> None:
        """Ask for an envelope (6, 3), each force scaled down to a normal component of at most `most_n` [N]."""
        share = np.minimum(1.0, most_n / np.maximum(envelope_W @ normal_W, 1e-9))
        self.asked_W = share[:, None] * envelope_W

    def begin(self, t0: float) -> None:
        """The first force is asked from t0 on."""
        self._t0, self._pressed, self.told, self.held_n = t0, [], 0, 0.0

    def asked_n(self, index: int, normal_W: np.ndarray) -> float:
        """Normal component of a force [N]."""
        return float(self.asked_W[index] @ normal_W)

    def update(self, t: float, force_n: float, normal_W: np.ndarray) -> list[Held]:
        """Take in the estimated normal force; the forces whose dwell ended since the last call."""
        settings = self._settings
        since = t - self._t0
        self._pressed.append((since, force_n))
        ended = []
        while not self.over and since >= (self.told + 1) * settings.dwell_s - 1e-9:
            end = (self.told + 1) * settings.dwell_s
            window = [force for at, force in self._pressed if end - _HELD_WINDOW_S <= at <= end]
            held, asked = float(np.mean(window)) if window else 0.0, self.asked_n(self.told, normal_W)
            ended.append(Held(self.told, asked, held, held >= settings.held_share * asked))
            self.held_n = max(self.held_n, held)
            self.told += 1
        return ended
