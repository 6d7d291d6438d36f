"""A depth image as points in the world, each with how well its height is known."""

from __future__ import annotations

from dataclasses import dataclass
from math import pi

import numpy as np

from surefoot.bus.messages import DepthFrame, StateEstimate
from surefoot.components.robot_model.rotation import matrix_of

_SLOPE = 0.3
"""Slope of the ground up to which a shift along it is counted in a height's variance."""


_ARM_MAX_M = 2.0
"""No camera on the trunk is farther from its origin."""


@dataclass(frozen=True)
class View:
    """One image and the pose it was taken from.

    Attributes:
        p_WC, R_WC: (3,) [m], (3, 3) of the camera; x along the optical axis, y left, z up in the image.
        tangent: (2,) of half the field of view, horizontal and vertical.
        depth_m: (rows, columns) along the optical axis; 0 where there is none [m].
    """

    p_WC: np.ndarray
    R_WC: np.ndarray
    tangent: np.ndarray
    depth_m: np.ndarray

    def depth_at(self, p_W: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """For points (k, 3): the image's depth at each (0: none or outside), and their own [m]."""
        p_C = (p_W - self.p_WC) @ self.R_WC
        ahead = p_C[:, 0] > 1e-3
        rows, columns = self.depth_m.shape
        inverse = 1.0 / np.where(ahead, p_C[:, 0], 1.0)
        column = np.floor(0.5 * columns * (1.0 - p_C[:, 1] * inverse / self.tangent[0])).astype(np.int64)
        row = np.floor(0.5 * rows * (1.0 - p_C[:, 2] * inverse / self.tangent[1])).astype(np.int64)
        inside = ahead & (row >= 0) & (row < rows) & (column >= 0) & (column < columns)
        seen = np.zeros(len(p_W))
        seen[inside] = self.depth_m[row[inside], column[inside]]
        return seen, p_C[:, 0]


@dataclass(frozen=True)
class Points:
    """Points in the world.

    Attributes:
        p_W: (k, 3) [m].
        noise_m2: (k,) variance of each height from the camera's noise, independent of the others' [m^2].
        tilt_m2: (k,) variance of each height from the base's tilt, the same error for all of an image [m^2].
    """

    p_W: np.ndarray
    noise_m2: np.ndarray
    tilt_m2: np.ndarray


def refusal(frame: DepthFrame) -> str:
    """Why an image cannot be used, in words; empty when it can."""
    if not frame.valid:
        return "io does not vouch for it"
    if frame.depth_m.size == 0:
        return "it has no pixels"
    if not (np.isfinite(frame.p_BC).all() and np.isfinite(frame.quat_BC).all()):
        return "the camera's pose is not finite"
    arm = float(np.hypot(np.hypot(*frame.p_BC[:2]), frame.p_BC[2]))  # without squares, which may overflow
    if arm > _ARM_MAX_M:
        return f"the camera is {arm:.3g} m from the trunk's origin, limit {_ARM_MAX_M:g} m"
    length = float(np.sqrt(frame.quat_BC @ frame.quat_BC))
    if abs(length - 1.0) > 1e-3:
        return f"the camera's quaternion has length {length:.3f}, not 1"
    if not ((frame.fov > 0.0) & (frame.fov < pi)).all():  # also when not a number
        return (
            f"its field of view is {frame.fov[0]:.3g} by {frame.fov[1]:.3g} rad: each must be above 0 and below pi"
        )
    if not (np.isfinite(frame.depth_m) & (frame.depth_m > 0.0)).any():
        return "no pixel has a depth: is the camera covered?"
    return ""


def view_of(frame: DepthFrame, estimate: StateEstimate) -> View:
    """The image from the pose of the estimate; what is no depth is 0."""
    R_WB = matrix_of(estimate.quat_WB)
    good = np.isfinite(frame.depth_m) & (frame.depth_m > 0.0)
    return View(
        p_WC=estimate.p_WB + R_WB @ frame.p_BC,
        R_WC=R_WB @ matrix_of(frame.quat_BC / np.sqrt(frame.quat_BC @ frame.quat_BC)),
        tangent=np.tan(0.5 * frame.fov),
        depth_m=np.where(good, frame.depth_m, 0.0).astype(np.float64),
    )


def points_of(view: View, estimate: StateEstimate, range_noise_m: float) -> Points:
    """The pixels that have a depth, as points.

    The base's position is not counted as uncertain: robot, map and feet share it, and what it drifts meanwhile
    makes old heights uncertain instead.

    Args:
        view: image and pose.
        estimate: of the same time; its tilt's covariance is used.
        range_noise_m: standard deviation of a pixel's depth at 1 m; it grows with the square of the depth [m].
    """
    rows, columns = view.depth_m.shape
    y = view.tangent[0] * (1.0 - (2.0 * np.arange(columns) + 1.0) / columns)
    z = view.tangent[1] * (1.0 - (2.0 * np.arange(rows) + 1.0) / rows)
    row, column = np.nonzero(view.depth_m)
    depth = view.depth_m[row, column]
    rays_W = view.R_WC[:, 0] + y[column, None] * view.R_WC[:, 1] + z[row, None] * view.R_WC[:, 2]
    p_W = view.p_WC + depth[:, None] * rays_W
    # A shift along the ray moves the height, and on a slope it moves what lies under the point.
    along = rays_W[:, 2] ** 2 + _SLOPE**2 * (rays_W[:, 0] ** 2 + rays_W[:, 1] ** 2)
    # R = exp(theta) R_estimated: a height moves by theta_x r_y - theta_y r_x.
    arm = p_W[:, :2] - estimate.p_WB[:2]
    C = estimate.covariance[6:8, 6:8]
    tilt = C[0, 0] * arm[:, 1] ** 2 - 2.0 * C[0, 1] * arm[:, 0] * arm[:, 1] + C[1, 1] * arm[:, 0] ** 2
    return Points(p_W=p_W, noise_m2=(range_noise_m * depth * depth) ** 2 * along, tilt_m2=np.maximum(tilt, 0.0))
