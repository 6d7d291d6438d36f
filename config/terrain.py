"""Typed descriptions of terrains; built in `hw/mujoco/terrain`."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import Literal

from surefoot.config.typed_toml import ConfigError


@dataclass(frozen=True)
class Planks:
    """Boards that turn on beams like levers, with a spring at their free end; level when unloaded.

    One row is a rigid beam and a board hinged on the beam's far edge; from above it is one flat surface.
    """

    rows: int = 4
    columns: int = 4
    board_length_m: float = 0.205  # from hinge to free end
    board_width_m: float = 0.20
    board_thickness_m: float = 0.015
    board_mass: float = 0.4  # [kg]
    beam_width_m: float = 0.04
    gap_m: float = 0.005  # between free end and next beam, and between columns
    stiffness: float = 500.0  # of the spring at the free end [N/m]
    damping: float = 10.0  # of the same [N s/m]
    preload_n: float = 4.0  # spring's push against the upper stop, at the free end
    travel_limit: float = 1.2  # how far a board turns down [rad]
    beam_direction: Literal["across", "along"] = "across"  # of travel
    frame_height_m: float = 0.20  # surface above the ground beneath
    run_up_m: float = 1.0
    run_out_m: float = 1.6
    start_offset_m: float = 0.05  # from the front feet to the first beam

    def __post_init__(self) -> None:
        if self.rows < 1 or self.columns < 1:
            raise ConfigError(f"planks of {self.rows} rows and {self.columns} columns: at least one of each")
        if self.stiffness <= 0.0:
            raise ConfigError(f"stiffness = {self.stiffness}: a plank's spring must push")

    @property
    def pitch_m(self) -> float:
        """Length of one row."""
        return self.beam_width_m + self.board_length_m + self.gap_m


@dataclass(frozen=True)
class Terrain:
    """Which ground, and its figures."""

    kind: Literal["flat", "planks"] = "flat"
    planks: Planks = field(default_factory=Planks)
