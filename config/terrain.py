"""Typed descriptions of terrains; built in `hw/mujoco/terrain`."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import Annotated, Literal

from surefoot.config.typed_toml import ConfigError, Within, ordered

Count = Annotated[int, Within(1, 50)]
Length = Annotated[float, Within(0.005, 5.0)]
Stiffness = Annotated[float, Within(1.0, 1e5)]  # above it a light board swings faster than the physics steps
Platform = Annotated[float, Within(0.1, 50.0)]
Offset = Annotated[float, Within(0.0, 10.0)]
FrameHeight = Annotated[float, Within(0.02, 5.0)]
Place = Annotated[int, Within(0, 49)]


@dataclass(frozen=True, kw_only=True)
class Approach:
    """The rigid ground before and behind, where a terrain stands alone."""

    run_up_m: Platform = 1.0
    run_out_m: Platform = 1.6
    start_offset_m: Offset = 0.05  # from the front feet to where the terrain begins


@dataclass(frozen=True, kw_only=True)
class Planks(Approach):
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
    frame_height_m: FrameHeight = 0.20  # surface above the ground beneath
    missing_count: Annotated[int, Within(0, 16)] = 0  # boards that are not there, drawn from the seed
    missing: tuple[tuple[Place, Place], ...] = ()  # or these: [row, column], each counted from 0

    def __post_init__(self) -> None:
        ordered(self, "board_thickness_m", "frame_height_m", "boards would lie in the ground beneath")
        for number, (row, column) in enumerate(self.missing):
            if row >= self.rows or column >= self.columns:
                raise ConfigError(
                    f"missing[{number}] = {[row, column]}: there are {self.rows} rows and {self.columns} columns, "
                    "counted from 0"
                )
        if self.missing and self.missing_count:
            raise ConfigError(
                f"missing_count = {self.missing_count} with missing = {[list(place) for place in self.missing]}: "
                "draw the boards or list them, not both"
            )
        most = self.rows * self.columns // 3 if self.columns > 1 else 0
        if self.missing_count > most:
            raise ConfigError(
                f"missing_count = {self.missing_count}: at most {most}, a third of {self.rows} rows of "
                f"{self.columns}, or there might be no way across"
            )

    @property
    def pitch_m(self) -> float:
        """Length of one row."""
        return self.beam_width_m + self.board_length_m + self.gap_m


@dataclass(frozen=True, kw_only=True)
class Slope(Approach):
    """Planks (those of `terrain.planks`) on an incline, up or down, between level run-up and run-out."""

    angle_min_deg: Annotated[float, Within(-20.0, 20.0)] = 5.0  # drawn between the two; above 0: uphill
    angle_max_deg: Annotated[float, Within(-20.0, 20.0)] = 10.0

    def __post_init__(self) -> None:
        ordered(self, "angle_min_deg", "angle_max_deg", "the angle is drawn between the two")


@dataclass(frozen=True, kw_only=True)
class Terrain:
    """Which ground, and its figures."""

    kind: Literal["flat", "planks", "slope"] = "flat"
    planks: Planks = field(default_factory=Planks)
    slope: Slope = field(default_factory=Slope)

    @property
    def approach(self) -> Approach | None:
        """Run-up and run-out of this kind, or None where it is all one plane."""
        return None if self.kind == "flat" else getattr(self, self.kind)
