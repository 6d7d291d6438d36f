"""Contact from the normal force, after successive hits (Sec. II-D.4)."""

from __future__ import annotations

import numpy as np

from surefoot.components.memory import Memory
from surefoot.config.estimator import Estimator


class ContactDetector:
    """A foot is in contact after `contact_hits` successive looks above the upper threshold, and in the air
    again after as many below the lower one.

    Attributes:
        contact: (4,) present verdicts.
        hits: (4,) successive looks that contradict them.
        cycle: calls of `update` so far.
    """

    memory = Memory("contact", "hits", "cycle")

    def __init__(self, settings: Estimator):
        self._settings = settings
        self.contact = np.zeros(4, bool)
        self.hits = np.zeros(4, np.int64)
        self.cycle = 0

    def update(self, normal_force_n: np.ndarray) -> np.ndarray:
        """Take in one cycle's normal forces (4,) [N]; returns (4,) contact."""
        self.cycle += 1
        if self.cycle % self._settings.contact_every:
            return self.contact
        settings = self._settings
        contradicts = np.where(
            self.contact, normal_force_n < settings.contact_off_n, normal_force_n > settings.contact_on_n
        )
        self.hits = np.where(contradicts, self.hits + 1, 0)
        turned = self.hits >= settings.contact_hits
        self.contact = self.contact ^ turned
        self.hits[turned] = 0
        return self.contact

    def assume(self, contact: np.ndarray) -> None:
        """Start from known contacts (4,)."""
        self.contact = np.array(contact, bool)
        self.hits[:] = 0
