"""Settings of `surefoot reproduce`: how long and from where the paper's experiments are run."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Annotated

from surefoot.config.typed_toml import ConfigError, Within

Offset = Annotated[float, Within(0.0, 1.0)]
Seconds = Annotated[float, Within(1.0, 3600.0)]
Goal = Annotated[float, Within(0.01, 100.0)]


@dataclass(frozen=True)
class Reproduce:
    """The paper's means are over five traversals from different starts (Sec. III-B.1)."""

    start_offsets_m: tuple[Offset, ...] = (0.05, 0.08, 0.11, 0.14, 0.17)  # front feet to planks, seed by seed
    flat_goal_m: Goal = 0.3  # each foot three steps: a dozen probes for Figs. 9 and 10
    quick_goal_m: Goal = 0.05  # each foot one step
    quick_limit_s: Seconds = 40.0  # of a crossing: a few footholds, and a collapse on the planks

    def __post_init__(self) -> None:
        if not self.start_offsets_m:
            raise ConfigError("start_offsets_m = []: give at least one distance, such as [0.05]")
