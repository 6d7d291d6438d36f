"""Settings of the model predictive controller."""

from __future__ import annotations

from dataclasses import dataclass


@dataclass(frozen=True)
class Mpc:
    """Horizon of 1.0 s at 0.015 s (Sec. III-A); the rate is in the topic table."""

    intervals: int = 67
    interval_s: float = 0.015
    lead_s: float = 0.015  # the plan begins this far ahead: budget of the solve and way of a command to the motors
