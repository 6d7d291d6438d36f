"""What each foothold has proved to bear."""

from __future__ import annotations

import numpy as np

from surefoot.components.memory import Memory
from surefoot.config.fsm import Fsm


class Certificates:
    """One certificate a foothold, given when it is accepted.

    Attributes:
        held_n: (4,) largest normal force each foothold has really borne [N].
        displaced_m: (4,) how far the foot had moved under it from where it touched down [m].
    """

    memory = Memory("held_n", "displaced_m")

    def __init__(self, settings: Fsm):
        self._settings = settings
        self.void()

    def void(self) -> None:
        """No foothold has been probed."""
        self.held_n, self.displaced_m = np.zeros(4), np.zeros(4)

    def give(self, leg: int, held_n: float, displaced_m: float) -> None:
        """A leg's foothold has borne a force [N], with the foot displaced by so much under it [m]."""
        self.held_n[leg], self.displaced_m[leg] = held_n, displaced_m

    def caps_n(self, trusted: np.ndarray) -> np.ndarray:
        """(4,) what feet that are `trusted` (4,) may be asked for [N]; 0, no cap: tested, in the air, sinking."""
        return np.where(trusted & self._settings.cap_forces, self.held_n, 0.0)
