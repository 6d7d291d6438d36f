"""How far each foot has moved on the ground since it was trusted, what it bore, and where it could go back to."""

from __future__ import annotations

import numpy as np

from surefoot.components.memory import Memory


class StanceWatch:
    """Displacement of the feet from their anchors, as the feet that carry the robot see it.

    The median displacement of the trusted feet is the drift of the estimate, not of the ground, and is taken
    off: one foot that sinks or slips stands out against the others. With fewer than three trusted feet
    nobody can tell the two apart, and the last drift stands.

    Attributes:
        drift_W: (3,) what the estimate has drifted since the anchors were first set [m].
        sunk: (4,) feet whose safe foothold has given way.
        borne_n: (4,) largest normal force on each foot since it was trusted or, later, set down again [N].
    """

    memory = Memory("drift_W", "sunk", "borne_n", "_anchor_W", "_safe_W")

    def __init__(self) -> None:
        self.drift_W = np.zeros(3)
        self.sunk = np.zeros(4, bool)
        self.borne_n = np.zeros(4)
        self._anchor_W = np.zeros((4, 3))
        self._safe_W = np.zeros((4, 3))

    def begin(self, p_WF: np.ndarray) -> None:
        """Trust all feet (4, 3) where they are."""
        self.drift_W[:], self.sunk[:], self.borne_n[:] = 0.0, False, 0.0
        self._anchor_W[:] = self._safe_W[:] = p_WF

    def update(self, p_WF: np.ndarray, trusted: np.ndarray) -> None:
        """Take in feet (4, 3) and which of them stand on trusted ground (4,)."""
        if trusted.sum() >= 3:
            moved = np.sort((p_WF - self._anchor_W)[trusted], axis=0)  # np.median takes ten times as long
            self.drift_W = moved[1] if len(moved) == 3 else 0.5 * (moved[1] + moved[2])

    def load(self, force_n: np.ndarray, bearing: np.ndarray) -> None:
        """Take in normal forces (4,) [N] and which feet stand (4,): in the air a leg's inertia looks like one."""
        self.borne_n = np.where(bearing, np.maximum(self.borne_n, force_n), self.borne_n)

    def touched(self, leg: int, p_F: np.ndarray) -> None:
        """A foot has found ground at a point (3,): from there its displacement counts, from now on its load."""
        self._anchor_W[leg] = p_F - self.drift_W
        self.borne_n[leg] = 0.0

    def trust(self, leg: int, p_F: np.ndarray) -> None:
        """A foothold (3,) has borne its load: it replaces the leg's last safe one."""
        self._anchor_W[leg] = self._safe_W[leg] = p_F - self.drift_W
        self.sunk[leg], self.borne_n[leg] = False, 0.0

    def safe(self, leg: int) -> np.ndarray:
        """(3,) the leg's last safe foothold, in the world as it is estimated now [m]."""
        return self._safe_W[leg] + self.drift_W

    def displacement(self, p_WF: np.ndarray) -> np.ndarray:
        """(4,) how far the feet (4, 3) are from where they were trusted or touched down [m]."""
        moved = p_WF - self._anchor_W - self.drift_W
        return np.sqrt((moved * moved).sum(axis=1))
