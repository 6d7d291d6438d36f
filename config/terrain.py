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
Crossed = Literal["planks", "slope", "rocks", "tiles", "foam", "trap", "edge"]
Load = Annotated[float, Within(1.0, 2000.0)]
Place = Annotated[int, Within(0, 49)]

_LAYERS_MOST = 6.0  # of stones, if each lay in a square of its largest extent: above, they are a wall


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
class Rocks(Approach):
    """Loose convex stones, lying as they came to rest on flat rigid ground."""

    count: Annotated[int, Within(1, 200)] = 90
    size_min_m: Annotated[float, Within(0.02, 0.5)] = 0.05  # largest extent, drawn between the two
    size_max_m: Annotated[float, Within(0.02, 0.5)] = 0.15
    flatness_min: Annotated[float, Within(0.1, 1.0)] = 0.35  # height over largest extent, drawn between the two
    flatness_max: Annotated[float, Within(0.1, 1.0)] = 0.6
    density_min: Annotated[float, Within(100.0, 10000.0)] = 2000.0  # drawn between the two [kg/m^3]
    density_max: Annotated[float, Within(100.0, 10000.0)] = 2600.0
    length_m: Annotated[float, Within(0.2, 5.0)] = 0.9  # of the ground they lie on
    width_m: Annotated[float, Within(0.2, 5.0)] = 1.1

    def __post_init__(self) -> None:
        ordered(self, "size_min_m", "size_max_m", "sizes are drawn between the two")
        ordered(self, "flatness_min", "flatness_max", "heights are drawn between the two")
        ordered(self, "density_min", "density_max", "densities are drawn between the two")
        for side in ("length_m", "width_m"):
            ordered(self, "size_max_m", side, "a stone would not fit on its ground")
        layers = self.count * self.size_max_m**2 / (self.length_m * self.width_m)
        if layers > _LAYERS_MOST:
            raise ConfigError(
                f"count = {self.count} of up to {self.size_max_m} m lie about {layers:.1f} layers high on "
                f"{self.length_m} x {self.width_m} m: at most {_LAYERS_MOST}; fewer, smaller or more ground"
            )


@dataclass(frozen=True, kw_only=True)
class Tiles(Approach):
    """Tiles held up against a stop; each bears up to its load, then its support snaps through."""

    rows: Count = 10
    columns: Count = 9
    tile_m: Annotated[float, Within(0.02, 1.0)] = 0.10
    gap_m: Annotated[float, Within(0.0, 0.02)] = 0.002
    mass: Annotated[float, Within(0.05, 20.0)] = 0.2  # [kg]
    load_min_n: Load = 40.0  # that a tile gives way at, drawn between the two
    load_max_n: Load = 160.0
    travel_m: Annotated[float, Within(0.02, 1.0)] = 0.11  # from stop to stop
    return_n: Annotated[float, Within(0.1, 100.0)] = 3.0  # push upwards at the lower stop, over the tile's weight
    damping: Annotated[float, Within(0.0, 1e3)] = 0.5  # [N s/m]
    brake: Annotated[float, Within(0.0, 1e4)] = 35.0  # of the speed cubed: snaps, yet does not fly [N s^3/m^3]
    frame_height_m: FrameHeight = 0.20  # surface above the ground beneath

    def __post_init__(self) -> None:
        ordered(self, "load_min_n", "load_max_n", "loads are drawn between the two")
        ordered(self, "travel_m", "frame_height_m", "a tile would stop below the ground beneath")
        ordered(self, "return_n", "load_min_n", "a tile that has given way would bear more than before")


@dataclass(frozen=True, kw_only=True)
class Trap(Tiles):
    """Tiles across the whole way of which none bears a foot: whoever is on the run-up has to stay there."""

    rows: Count = 5
    columns: Count = 8
    tile_m: Annotated[float, Within(0.02, 1.0)] = 0.20
    load_min_n: Load = 4.0
    load_max_n: Load = 8.0  # where four tiles meet a foot has the support of all of them
    travel_m: Annotated[float, Within(0.02, 1.0)] = 0.17
    start_offset_m: Offset = 0.02


@dataclass(frozen=True, kw_only=True)
class Foam(Approach):
    """Soft pads that sink under a foot and bear it."""

    rows: Count = 5
    columns: Count = 5
    pad_m: Annotated[float, Within(0.02, 1.0)] = 0.20
    gap_m: Annotated[float, Within(0.0, 0.02)] = 0.002
    mass: Annotated[float, Within(0.05, 20.0)] = 0.5  # [kg]
    force_n: Load = 110.0  # at which a pad sinks ...
    sink_min_m: Annotated[float, Within(0.001, 0.025)] = 0.002  # ... this far, drawn between the two
    sink_max_m: Annotated[float, Within(0.001, 0.025)] = 0.025
    relaxation_s: Annotated[float, Within(0.001, 0.1)] = (
        0.025  # a sudden force has sunk it by 63 % after this time
    )
    thickness_m: Annotated[float, Within(0.01, 0.5)] = 0.08

    def __post_init__(self) -> None:
        ordered(self, "sink_min_m", "sink_max_m", "sinkings are drawn between the two")
        ordered(self, "sink_max_m", "thickness_m", "a pad would be pressed flat before")


@dataclass(frozen=True, kw_only=True)
class Edge(Approach):
    """Rigid ground that drops a little just beyond where a front foot is meant to land."""

    distance_m: Annotated[float, Within(0.0, 5.0)] = 0.095  # from the front of the front feet to the drop
    distance_spread_m: Annotated[float, Within(0.0, 0.5)] = 0.025  # drawn uniform +- this
    drop_min_m: Annotated[float, Within(0.0, 0.3)] = 0.02  # drawn between the two
    drop_max_m: Annotated[float, Within(0.0, 0.3)] = 0.04
    length_m: Length = 0.25  # until it counts as crossed; the lower ground goes on
    start_offset_m: Offset = 0.0

    def __post_init__(self) -> None:
        ordered(self, "drop_min_m", "drop_max_m", "the drop is drawn between the two")
        ordered(self, "distance_spread_m", "distance_m", "the drop could lie behind the start")
        if self.distance_m + self.distance_spread_m >= self.length_m:
            raise ConfigError(
                f"distance_m = {self.distance_m} +- distance_spread_m = {self.distance_spread_m} is not within "
                f"length_m = {self.length_m}: the drop could lie beyond the end; make it longer"
            )


@dataclass(frozen=True, kw_only=True)
class Lane(Approach):
    """Several of the others in a row, each with the figures of its own section, rigid platforms between them."""

    sections: tuple[Crossed, ...] = ("planks", "rocks", "foam", "tiles")
    platform_m: Platform = 0.6  # long enough for a robot to stand on

    def __post_init__(self) -> None:
        if not self.sections:
            raise ConfigError('sections = []: name at least one, such as ["planks", "rocks"]')


@dataclass(frozen=True, kw_only=True)
class Terrain:
    """Which ground, and its figures."""

    kind: Literal["flat", "planks", "slope", "rocks", "tiles", "foam", "trap", "edge", "lane"] = "flat"
    planks: Planks = field(default_factory=Planks)
    slope: Slope = field(default_factory=Slope)
    rocks: Rocks = field(default_factory=Rocks)
    tiles: Tiles = field(default_factory=Tiles)
    foam: Foam = field(default_factory=Foam)
    trap: Trap = field(default_factory=Trap)
    edge: Edge = field(default_factory=Edge)
    lane: Lane = field(default_factory=Lane)

    @property
    def row(self) -> tuple[Crossed, ...]:
        """What stands in a row along the way."""
        if self.kind == "flat":
            return ()
        return self.lane.sections if self.kind == "lane" else (self.kind,)

    @property
    def approach(self) -> Approach | None:
        """Run-up and run-out of this kind, or None where it is all one plane."""
        return None if self.kind == "flat" else getattr(self, self.kind)
