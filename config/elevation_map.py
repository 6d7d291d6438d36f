"""Settings of the elevation map and of the visual foothold adaptation (VFA)."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Annotated

from surefoot.config.typed_toml import Within

Length = Annotated[float, Within(0.1, 20.0)]
Noise = Annotated[float, Within(0.0, 0.2)]
Small = Annotated[float, Within(1e-4, 0.2)]
Offset = Annotated[float, Within(0.005, 1.0)]
Frames = Annotated[int, Within(1, 100)]


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
    motion_m: Noise = 0.01  # how the base's way makes old heights uncertain [m/sqrt(m)]
    surface_m: Small = 0.03  # points of a cell that far below its highest are of another, lower surface
    gate: Annotated[float, Within(1.0, 1e4)] = 9.0  # squared Mahalanobis distance beyond which a height is doubted
    takeover_frames: Frames = 3  # so many frames in a row that doubt or disprove a height change it
    clearance_m: Offset = 0.05  # a ray that passes this far below a height disproves it

    # Drift of the base's height against the map, told by the feet that stand.
    drift_gain: Annotated[float, Within(0.0, 1.0)] = 0.1  # share taken with each frame
    drift_max_m: Offset = 0.1  # what is more is no drift
    jump_m: Offset = 0.05  # the estimate cannot move faster than the robot by more than this: it was started again
