"""Settings of the operator's hand on the robot: what happens when nobody is there, or a stop is not obeyed."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Annotated

from surefoot.config.typed_toml import ConfigError, Within

_SHORTEST_S = 0.5  # four beats, each at one of ten looks a second that a supervisor takes


@dataclass(frozen=True)
class Operator:
    """Of stops that people, or their absence, ask for."""

    heartbeat_s: Annotated[float, Within(0.0, 60.0)] = (
        0.0  # without a beat for so long the robot sits; 0: none asked
    )
    settle_s: Annotated[float, Within(2.0, 120.0)] = 15.0  # told to sit, and still driven after so long: io damps

    def __post_init__(self) -> None:
        if 0.0 < self.heartbeat_s < _SHORTEST_S:
            raise ConfigError(
                f"heartbeat_s = {self.heartbeat_s}: at least {_SHORTEST_S}, or one late beat stops the robot; 0 "
                "asks for none"
            )

    @property
    def beat_s(self) -> float:
        """From one beat of the operator's side to the next [s]."""
        return self.heartbeat_s / 4.0
