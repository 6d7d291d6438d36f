"""How far the base's height has drifted against the map, from the feet that stand on what was seen before."""

from __future__ import annotations

import numpy as np

from surefoot.bus.messages import MotionReference, StateEstimate
from surefoot.components.elevation_map.torus import Torus
from surefoot.components.footing import is_trusted

_FEET_LEAST = 2
"""One foot alone may have sunk with its ground."""


def height_drift(
    torus: Torus, estimate: StateEstimate, reference: MotionReference | None, foot_radius_m: float, most_m: float
) -> float | None:
    """Median over the trusted stance feet of contact height less map height [m]; None with fewer than two.

    Of an even number the upper one of the two in the middle: ground sinks under a foot, it never rises.

    Args:
        torus: its layer `height` is compared; the median of the nine cells at a foot, if most are known.
        estimate: feet, contacts and the surface's normal.
        reference: says which feet stand on ground that is trusted; None: none do.
        foot_radius_m: the foot's centre is that far above the ground, along the normal.
        most_m: a foot that is further off is on something else than was seen, and does not count.
    """
    if reference is None:
        return None
    standing = is_trusted(reference.leg_status) & estimate.contact
    ground = estimate.p_WF[standing] - foot_radius_m * estimate.normal_W
    off = []
    for p_W in ground:
        heights = torus.block(torus.cells(p_W[:2]) - 1, (3, 3))["height"]
        known = heights[~np.isnan(heights)]
        if len(known) > 4:
            off.append(float(p_W[2] - np.median(known)))
    near = sorted(each for each in off if abs(each) <= most_m)
    return near[len(near) // 2] if len(near) >= _FEET_LEAST else None
