"""The GRF envelope: what the next foothold has to bear (Sec. II-B.6)."""

from __future__ import annotations

import numpy as np


def grf_envelope(t: np.ndarray, force_W: np.ndarray, start: float, end: float, normal_W: np.ndarray) -> np.ndarray:
    """The full force vectors at the maximum and minimum of each component while the foot stands.

    Whole vectors, not mixed components: each is inside the friction cone because the plan's force was.

    Args:
        t: (N,) start of each interval [s].
        force_W: (N, 3) contact force of the foot [N].
        start, end: the stance phase to look at [s].
        normal_W: (3,) surface normal.

    Returns:
        (6, 3) forces [N], by rising normal component, so that weak ground shows at a low load.
    """
    stance = force_W[(t >= start) & (t <= end)]
    picks = np.concatenate([stance.argmax(axis=0), stance.argmin(axis=0)])
    envelope = stance[picks]
    return envelope[np.argsort(envelope @ normal_W, kind="stable")]
