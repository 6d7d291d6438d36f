"""Typed descriptions of terrains; built in `hw/mujoco/terrain`."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import Annotated, Literal

from surefoot.config.typed_toml import Within, ordered

Count = Annotated[int, Within(1, 50)]
Length = Annotated[float, Within(0.005, 5.0)]
Stiffness = Annotated[float, Within(1.0, 1e5)]  # above it a light board swings faster than the physics steps
Platform = Annotated[float, Within(0.1, 50.0)]


@dataclass(frozen=True)
class Planks:
    """Boards that turn on beams like levers, with a spring at their free end; level when unloaded.

    One row is a rigid beam and a board hinged on the beam's far edge; from above it is one flat surface.
    """

    rows: Count = 4
    columns: Count = 4
    board_length_m: Length = 0.205  # from hinge to free end
    board_width_m: Length = 0.20
    board_thickness_m: Annotated[float, Within(0.001, 0.5)] = 0.015
    board_mass: Annotated[float, Within(0.1, 100.0)] = 0.4  # [kg]
    beam_width_m: Length = 0.04
    gap_m: Annotated[float, Within(0.0, 0.2)] = 0.005  # between free end and next beam, and between columns
    stiffness: Stiffness = 500.0  # of the spring at the free end [N/m]
    damping: Annotated[float, Within(0.0, 1e4)] = 10.0  # of the same [N s/m]
    preload_n: Annotated[float, Within(0.0, 500.0)] = 4.0  # spring's push against the upper stop, at the free end
    travel_limit: Annotated[float, Within(0.05, 1.55)] = 1.2  # how far a board turns down [rad]
    beam_direction: Literal["across", "along"] = "across"  # of travel
    frame_height_m: Annotated[float, Within(0.02, 5.0)] = 0.20  # surface above the ground beneath
    run_up_m: Platform = 1.0
    run_out_m: Platform = 1.6
    start_offset_m: Annotated[float, Within(0.0, 10.0)] = 0.05  # from the front feet to the first beam

    def __post_init__(self) -> None:
        ordered(self, "board_thickness_m", "frame_height_m", "boards would lie in the ground beneath")

    @property
    def pitch_m(self) -> float:
        """Length of one row."""
        return self.beam_width_m + self.board_length_m + self.gap_m


@dataclass(frozen=True)
class Terrain:
    """Which ground, and its figures."""

    kind: Literal["flat", "planks"] = "flat"
    planks: Planks = field(default_factory=Planks)
