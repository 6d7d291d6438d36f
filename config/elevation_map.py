"""Settings of the elevation map and of the visual foothold adaptation (VFA)."""

from __future__ import annotations

from dataclasses import dataclass
from math import tan
from typing import Annotated

from surefoot.config.quantities import Share
from surefoot.config.typed_toml import ConfigError, Within

Length = Annotated[float, Within(0.1, 20.0)]
Noise = Annotated[float, Within(0.0, 0.2)]
Small = Annotated[float, Within(1e-4, 0.2)]
Offset = Annotated[float, Within(0.005, 1.0)]
Frames = Annotated[int, Within(1, 100)]
Tolerance = Annotated[float, Within(0.001, 0.5)]  # 0 would be met by no measured ground


_CELLS_MAX = 250_000
"""Of a map: every message on map/elevation holds 20 bytes of each, and every image is matched with all of them."""


@dataclass(frozen=True)
class Vfa:
    """Visual foothold adaptation (Sec. II-A): what a cell must be to be safe."""

    # Of a heightmap's cells unknown or older than age_max_s: above it there is no map, the plane is allowed.
    unmapped_share: Share = 0.5
    std_max_m: Tolerance = 0.02  # of a cell's height
    # Hind feet come to what the camera saw ahead of the front feet a metre of walking, or seven minutes, before.
    age_max_s: Annotated[float, Within(1.0, 1e5)] = 600.0
    disc_margin_m: Annotated[float, Within(0.0, 0.1)] = 0.005  # round the foot's disc, for an error of the map
    # Share of the cells under a foot that may be unknown, or uncertain; a half still tells its plane.
    disc_gaps_max: Annotated[float, Within(0.0, 0.5)] = 0.1
    plane_error_max_m: Tolerance = 0.02  # ROUGH: farthest cell from the plane fitted under the foot
    slope_max: Annotated[float, Within(0.05, 1.2)] = 0.5236  # STEEP: of that plane [rad]; 30 degrees
    edge_max_m: Tolerance = 0.03  # EDGE: difference in height of cells close to each other under the foot
    clearance_m: Annotated[float, Within(0.0, 0.2)] = 0.02  # LEG: between the ground and foot, calf or thigh


@dataclass(frozen=True)
class ElevationMap:
    """A robot-centric grid of heights; with `run.vision` off it is never filled."""

    cell_m: Annotated[float, Within(0.005, 0.1)] = 0.02
    length_m: Length = 2.4  # along the world's x axis
    width_m: Length = 1.6  # along y
    publish_s: Annotated[float, Within(0.05, 60.0)] = 0.5  # between two messages on map/elevation

    # Heights.
    range_noise_m: Noise = 0.002  # standard deviation of a pixel's depth at 1 m; grows with its square
    std_min_m: Small = 0.003  # of a frame's height of a cell: a cell is no point
    std_floor_m: Small = 0.001  # of a height however often it was seen: images share errors, and ground yields
    motion_m: Noise = 0.003  # how the base's way makes old heights uncertain [m/sqrt(m)]
    surface_m: Small = 0.03  # points of a cell that far below its highest are of another, lower surface
    gate: Annotated[float, Within(1.0, 1e4)] = 9.0  # squared Mahalanobis distance beyond which a height is doubted
    takeover_frames: Frames = 3  # so many frames in a row that doubt or disprove a height change it
    clearance_m: Offset = 0.05  # a ray that passes this far below a height disproves it

    # Drift of the base's height against the map, told by the feet that stand.
    drift_gain: Annotated[float, Within(0.0, 1.0)] = 0.1  # share taken with each frame
    drift_max_m: Offset = 0.1  # what is more is no drift
    jump_m: Offset = 0.05  # the estimate cannot move faster than the robot by more than this: it was started again

    vfa: Vfa = Vfa()

    def __post_init__(self) -> None:
        cells = round(self.length_m / self.cell_m) * round(self.width_m / self.cell_m)
        if cells > _CELLS_MAX:
            raise ConfigError(
                f"length_m = {self.length_m} by width_m = {self.width_m} of cell_m = {self.cell_m} are {cells} "
                f"cells, at most {_CELLS_MAX}; make the map smaller or its cells larger"
            )
        rise = self.cell_m * tan(self.vfa.slope_max)
        if rise > self.vfa.edge_max_m:
            raise ConfigError(
                f"vfa.edge_max_m = {self.vfa.edge_max_m}: ground of vfa.slope_max = {self.vfa.slope_max} rises "
                f"{rise:.3f} m from cell to cell (cell_m = {self.cell_m}) and would be all edges; raise it, or "
                "lower one of the two"
            )
