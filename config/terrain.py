"""Typed descriptions of terrains; built in `hw/mujoco`."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Literal


@dataclass(frozen=True)
class Terrain:
    """Which ground, and the figures of the planks."""

    kind: Literal["flat", "planks"] = "flat"
