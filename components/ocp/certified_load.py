"""The largest normal force that each foot may be asked for, from what its foothold has been found to bear."""

from __future__ import annotations

import numpy as np

LEAST_SHARE = 0.45
"""No foot is capped below this share of the weight.

A crawl stands on three feet, and the neighbours of the one in the air bear (W/2)(1 - m/h) each with the centre of
mass m inside their diagonal and the third foot h beyond it: 0.4 W where the base is sent. Eq. (1c) always holds:
with less than it needs, the base would not keep off the footholds but sink or tip.
"""


def normal_force_max(certified_n: np.ndarray, weight_n: float) -> np.ndarray:
    """Limits of the normal force on certified footholds, but never less than the robot needs to crawl.

    Args:
        certified_n: (..., 4) largest normal force each foothold is certified for; 0: not known [N].
        weight_n: the robot's [N].

    Returns:
        (..., 4) limits [N]; infinite where nothing is known: the limit of the robot.
    """
    return np.where(certified_n > 0.0, np.maximum(certified_n, LEAST_SHARE * weight_n), np.inf)
