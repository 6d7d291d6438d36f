"""Settings of the model predictive controller."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Annotated, Literal

from surefoot.config.typed_toml import ConfigError, Within

_PROFILES = {"paper": (67, 0.015, 0.015), "light": (40, 0.025, 0.025)}
"""Intervals, interval [s] and lead [s] of each profile; the rate of each is in the topic table."""

_HORIZON_MIN_S = 0.2
"""Lift-offs are announced 0.1 s ahead, and a policy is followed until it is 0.1 s old."""


@dataclass(frozen=True)
class Mpc:
    """Horizon of 1.0 s: 67 intervals of 15 ms at 100 Hz (Sec. III-A), or 40 of 25 ms at 50 Hz.

    The light profile is for machines that cannot solve the paper's in real time. A figure left at 0 is the
    profile's.

    Attributes:
        lead_s: the plan begins this far ahead: budget of the solve and way of a command to the motors.
        iterations: of the SQP in one tick, at the most: after the first, only while a step was scaled down.
    """

    profile: Literal["paper", "light"] = "paper"
    intervals: Annotated[int, Within(0, 200)] = 0
    interval_s: Annotated[float, Within(0.0, 0.1)] = 0.0
    lead_s: Annotated[float, Within(0.0, 0.1)] = 0.0
    iterations: Annotated[int, Within(1, 10)] = 3

    def __post_init__(self) -> None:
        names = ("intervals", "interval_s", "lead_s")
        for name, figure in zip(names, _PROFILES[self.profile], strict=True):
            if not getattr(self, name):
                object.__setattr__(self, name, figure)
        horizon_s = self.intervals * self.interval_s
        if horizon_s < _HORIZON_MIN_S:
            raise ConfigError(
                f"intervals = {self.intervals} of interval_s = {self.interval_s} look {horizon_s:g} s ahead: "
                f"at least {_HORIZON_MIN_S} s"
            )
