"""How far each foot has moved on the ground since it was trusted."""

from __future__ import annotations

import numpy as np


class StanceWatch:
    """Displacement of the feet from their anchors, as the feet that carry the robot see it.

    The median displacement of the stance feet is the drift of the estimate, not of the ground, and is taken
    off: one foot that sinks or slips stands out against the others.

    Attributes:
        anchor_W: (4, 3) position of each foot when it was last trusted, or first touched while probed [m].
    """

    def __init__(self) -> None:
        self.anchor_W = np.zeros((4, 3))

    def displacement(self, p_WF: np.ndarray, stance: np.ndarray) -> np.ndarray:
        """(4, 3) displacement of each foot in the world [m]; `stance` (4,) tells the feet that carry."""
        moved = p_WF - self.anchor_W
        return moved - np.median(moved[stance], axis=0) if stance.sum() >= 3 else moved
