"""Settings of the trajectory optimisation of one stride."""

from __future__ import annotations

from dataclasses import dataclass


@dataclass(frozen=True)
class Trajopt:
    """A stride of 4.0 s (Sec. II-B.3): each leg in turn, on four feet first, then in swing."""

    intervals: int = 80
    interval_s: float = 0.05
    shift_s: float = 0.35  # on four feet before each swing
    swing_s: float = 0.65
    swing_height: float = 0.08  # [m]
    swing_v_lift: float = 0.1  # [m/s]
    swing_v_touch: float = 0.1  # [m/s]
    iterations: int = 5
    tolerance: float = 1e-3  # largest state change at which the SQP stops
    envelope_trim_s: float = 0.05  # of the stance phase, left out at both ends
    envelope_scale: float = 1.0
    cone_regularisation_n2: float = 25.0  # rounder than the MPC's: asks at least 10 N of a stance foot
