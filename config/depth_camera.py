"""The body-mounted depth camera."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Annotated

from surefoot.config.typed_toml import Within, ordered

Angle = Annotated[float, Within(0.1, 2.6)]
Offset = Annotated[float, Within(-1.0, 1.0)]
Range = Annotated[float, Within(0.02, 20.0)]


@dataclass(frozen=True)
class DepthCamera:
    """Pose, image and noise of the camera; it looks forward and down from the front of the trunk."""

    p_B: tuple[Offset, Offset, Offset] = (0.33, 0.0, 0.02)  # optical centre in the trunk [m]
    pitch: Annotated[float, Within(-1.57, 1.57)] = 0.95  # optical axis below the trunk's x axis [rad]
    fov_x: Angle = 1.57  # horizontal, of a wide stereo camera [rad]
    fov_y: Angle = 1.13  # vertical: from under the trunk's front end to 1 m ahead of it [rad]
    columns: Annotated[int, Within(2, 640)] = 80
    rows: Annotated[int, Within(2, 480)] = 60
    rate_hz: Annotated[float, Within(4.0, 60.0)] = 15.0  # slower, the map would be stale between two images
    range_min_m: Range = 0.10
    range_max_m: Range = 3.0
    noise_m: Annotated[float, Within(0.0, 0.2)] = (
        0.002  # standard deviation of the depth at 1 m; grows with its square
    )
    dropout: Annotated[float, Within(0.0, 1.0)] = 0.02  # share of pixels without a value
    slit_m: Annotated[float, Within(0.0, 0.1)] = (
        0.013  # matching windows bridge slits up to this at least; where two of 5 mm meet they are that wide [m]
    )

    def __post_init__(self) -> None:
        ordered(self, "range_min_m", "range_max_m", "no pixel would ever have a value")
