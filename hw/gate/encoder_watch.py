"""Whether the encoders still measure."""

from __future__ import annotations

import numpy as np

from surefoot.config.gate import Gate as Settings
from surefoot.config.robot import JOINT_NAMES, JOINTS
from surefoot.hw.gate.check import Check, Violation
from surefoot.hw.robot_interface import MotorLaw

_LEG_OF = np.arange(12) // len(JOINTS)
_SAME_LEG = _LEG_OF[:, None] == _LEG_OF


class EncoderWatch:
    """Finds a joint of which the angle stays the same to the last digit while it has to change.

    It has to when the angle that its law pulls it to moves, or when another joint of its leg does. One at rest may
    well read the same figure for long, and that alone says nothing.
    """

    def __init__(self, settings: Settings):
        self._most, self._moved = settings.encoder_stuck_cycles, settings.encoder_moved
        self._q = np.full(12, np.nan)
        self._unchanged = np.zeros(12, int)
        self._pulled = np.zeros(12, bool)  # by a law with a position gain
        self._reference_then = np.zeros(12)
        self._q_then = np.zeros((12, 12))  # a row for each joint: all angles when it last changed

    def violation(self, q: np.ndarray, law: MotorLaw, driven: bool) -> Violation | None:
        """Look at a new reading of the angles (12,) [rad], under a law; of a robot that is driven, or not."""
        changed = (q != self._q) | (not driven)
        self._q = q
        self._unchanged += 1
        self._unchanged[changed] = 0
        begins = changed | ~self._pulled
        self._pulled = law.kp > 0.0
        self._reference_then[begins] = law.q[begins]
        self._q_then[changed] = q
        if self._unchanged.max() <= self._most:
            return None
        led = np.where(self._pulled, np.abs(law.q - self._reference_then), 0.0)
        moved = np.maximum(led, (np.abs(q - self._q_then) * _SAME_LEG).max(axis=1))
        stuck = (self._unchanged > self._most) & (moved > self._moved)
        if not stuck.any():
            return None
        joint = int(np.argmax(stuck))
        return Violation(
            Check.ENCODER,
            f"measured q of {JOINT_NAMES[joint]} = {q[joint]:.4f} has not changed for {self._unchanged[joint]} "
            f"cycles, in which it was to move or its leg moved by {moved[joint]:.2f} rad, limit {self._moved:.2f}",
        )
