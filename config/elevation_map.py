"""Settings of the elevation map and of the visual foothold adaptation (VFA)."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Annotated

from surefoot.config.typed_toml import Within

Length = Annotated[float, Within(0.1, 20.0)]


@dataclass(frozen=True)
class ElevationMap:
    """A robot-centric grid of heights; with `run.vision` off it is never filled."""

    cell_m: Annotated[float, Within(0.005, 0.1)] = 0.02
    length_m: Length = 2.4  # along the world's x axis
    width_m: Length = 1.6  # along y
