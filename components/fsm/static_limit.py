"""The largest force that a foot can press with while the robot stands still."""

from __future__ import annotations

import numpy as np


def static_limit(p_WF: np.ndarray, leg: int, inside_m: float, weight_n: float) -> float:
    """Normal force of one foot when its two neighbours are unloaded and the opposite foot bears the rest [N].

    Moments about the diagonal of the neighbours: f = W (h_o - m) / (h_o + h), with the foot h outside the
    diagonal, the opposite foot h_o and the centre of mass m on the other side of it. On a rectangle that is
    (W/2)(1 - m/h). It falls fast when the opposite foot stands close to the diagonal, as after a long step.

    Args:
        p_WF: (4, 3) feet [m].
        leg: the foot that presses.
        inside_m: distance that the centre of mass must keep from the diagonal [m].
        weight_n: the robot's [N].

    Returns:
        The limit, at least 0 [N]; 0 where the foot and the opposite one are not on two sides of the diagonal.
    """
    opposite = 3 - leg
    start, end = (p_WF[other, :2] for other in range(4) if other not in (leg, opposite))
    along = (end - start) / np.hypot(*(end - start))
    outside, beyond = (along[0] * d[1] - along[1] * d[0] for d in (p_WF[[leg, opposite], :2] - start))
    if outside * beyond >= 0.0:
        return 0.0
    h, h_opposite = abs(outside), abs(beyond)
    return float(weight_n * max(h_opposite - inside_m, 0.0) / (h + h_opposite))
