"""The simulated depth camera: rays into the scene, and what a stereo camera makes of their returns."""

from __future__ import annotations

from math import ceil, cos, sin, tan

import mujoco
import numpy as np

from surefoot.config.depth_camera import DepthCamera as Settings
from surefoot.hw.mujoco.plant import stream
from surefoot.hw.robot_interface import DepthImage

_COPLANAR_M = 0.005
"""Two returns on either side of a slit are one surface if each lies this near to the other's tangent plane."""

_IN_FRONT = 1.0001
"""Share of its inverse depth by which a surface must be nearer to be in front: rounding is none."""

_RADIUS_MAX = 4
"""Half a matching window at the most [pixels]: it is as wide as a slit only down to some nearest distance."""

_PAIRS = ((0, 1), (1, 0), (1, 1), (1, -1))
"""(row, column) steps to one of two opposite neighbours; the other is as far on the other side."""


class DepthCamera:
    """A depth camera on the trunk, by ray casting: one ray for each pixel and for a margin around the image.

    A stereo camera does not measure a pixel by itself: it matches a window of the one image in the other, and a
    window takes the depth of the surface that fills most of it. Slits narrower than a window are therefore
    bridged. Here a pixel with one and the same surface in front of it on two opposite sides, within half a
    window, is on that surface. Half a window is one pixel, or as many as span `slit_m`. Holes wider than a
    window keep their shape, and a plane stays as it is, seen from however flat an angle.
    """

    def __init__(self, settings: Settings, model: mujoco.MjModel, seed: int):
        """Of a compiled scene with the robot in it; `seed` draws noise and dropouts."""
        self._settings, self._model = settings, model
        self._trunk = model.body("trunk").id
        self._own_geom = np.append(model.geom_contype == 1, False)  # the last one answers to id -1: no return
        self._noise, self._dropout = (stream(seed, name) for name in ("depth_noise", "depth_dropout"))
        self._p_BC = np.array(settings.p_B)
        half = 0.5 * settings.pitch
        self._quat_BC = np.array([cos(half), 0.0, sin(half), 0.0])
        c, s = cos(settings.pitch), sin(settings.pitch)
        self._R_BC = np.array([[c, 0.0, s], [0.0, 1.0, 0.0], [-s, 0.0, c]])
        self._pixel = (
            2.0 * tan(0.5 * settings.fov_y) / settings.rows,
            2.0 * tan(0.5 * settings.fov_x) / settings.columns,
        )
        nearest = min(self._pixel) * settings.range_min_m
        self._pad = min(max(ceil(settings.slit_m / nearest), 1), _RADIUS_MAX) if settings.slit_m else 0
        self._rays_C = self._lattice()
        self._shape = self._rays_C.shape[:2]
        length = np.linalg.norm(self._rays_C, axis=2)
        self._units_C = (self._rays_C / length[..., None]).reshape(-1, 3)
        self._axial = (1.0 / length).reshape(-1)
        self._reach = settings.range_max_m * float(length.max())
        count = len(self._units_C)
        self._geom, self._distance = np.zeros(count, np.int32), np.zeros(count)
        self._normal_W = np.zeros((count, 3))

    def image(self, data: mujoco.MjData) -> DepthImage:
        """What the camera sees at the present instant; draws of the noise and dropout streams."""
        depth = self._bridged(*self._cast(data))
        settings = self._settings
        noise = self._noise.standard_normal(depth.shape)
        dropped = self._dropout.random(depth.shape) < settings.dropout
        depth += settings.noise_m * depth * depth * noise
        depth[dropped | (depth < settings.range_min_m) | (depth > settings.range_max_m)] = 0.0
        return DepthImage(
            p_BC=self._p_BC,
            quat_BC=self._quat_BC,
            fov=np.array([settings.fov_x, settings.fov_y]),
            depth_m=depth.astype(np.float32),
        )

    def _lattice(self) -> np.ndarray:
        """(rows + 2 pad, columns + 2 pad, 3) rays in C with a length of 1 along the optical axis."""
        settings, pad = self._settings, self._pad
        z = self._pixel[0] * (0.5 * settings.rows - 0.5 - np.arange(-pad, settings.rows + pad))
        y = self._pixel[1] * (0.5 * settings.columns - 0.5 - np.arange(-pad, settings.columns + pad))
        rays = np.ones((len(z), len(y), 3))
        rays[..., 1], rays[..., 2] = y[None, :], z[:, None]
        return rays

    def _cast(self, data: mujoco.MjData) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
        """Inverse depth [1/m], 0 without a return; hits of the robot itself; normals in C; margin included."""
        R_WC = data.xmat[self._trunk].reshape(3, 3) @ self._R_BC
        p_WC = data.xpos[self._trunk] + data.xmat[self._trunk].reshape(3, 3) @ self._p_BC
        units_W = np.ascontiguousarray(self._units_C @ R_WC.T)
        mujoco.mj_multiRay(
            self._model,
            data,
            p_WC,
            units_W.reshape(-1),
            None,
            True,
            -1,
            self._geom,
            self._distance,
            self._normal_W.reshape(-1),
            len(units_W),
            self._reach,
        )
        hit = self._distance > 1e-6
        inverse = np.zeros(len(hit))
        np.divide(1.0, self._distance * self._axial, out=inverse, where=hit)
        own = self._own_geom[self._geom] & hit
        normals_C = self._normal_W @ R_WC
        return inverse.reshape(self._shape), own.reshape(self._shape), normals_C.reshape(*self._shape, 3)

    def _bridged(self, inverse: np.ndarray, own: np.ndarray, normals_C: np.ndarray) -> np.ndarray:
        """(rows, columns) depth [m] without slits and without the robot; 0 where there is none.

        The inverse depth of a plane is linear over the image, so that the mean of two opposite neighbours is the
        plane's own value between them.
        """
        pad, settings = self._pad, self._settings
        rows, columns = settings.rows, settings.columns
        inside = np.s_[pad : pad + rows, pad : pad + columns]
        best, blocked = inverse[inside].copy(), own[inside].copy()
        # A window is as wide as a slit at the depth of the surface, which is nearer than what is seen through it.
        most = settings.slit_m * float(inverse.max())
        for k in range(1, pad + 1):
            if k > 1 and min(self._pixel) * (k - 1) >= most:
                break
            for step in _PAIRS:
                a, b = self._moved(inverse, step, k), self._moved(inverse, step, -k)
                mean = 0.5 * (a + b)
                needed = (mean > _IN_FRONT * best) & (min(self._pixel) * (k - 1) < settings.slit_m * mean)
                near = self._moved(own, step, k) | self._moved(own, step, -k)
                if k == 1:
                    blocked |= near
                rows_at, columns_at = np.nonzero(needed & (a > 0.0) & (b > 0.0) & ~near)
                if len(rows_at):
                    one = self._one_surface(inverse, normals_C, rows_at + pad, columns_at + pad, step, k)
                    at = rows_at[one], columns_at[one]
                    best[at] = mean[at]
        best[blocked] = 0.0
        depth = np.zeros_like(best)
        np.divide(1.0, best, out=depth, where=best > 0.0)
        return depth

    def _moved(self, field: np.ndarray, step: tuple[int, int], k: int) -> np.ndarray:
        """The image's part of a field with margin, `k` steps on."""
        row, column = self._pad + k * step[0], self._pad + k * step[1]
        return field[row : row + self._settings.rows, column : column + self._settings.columns]

    def _one_surface(self, inverse, normals_C, row, column, step, k) -> np.ndarray:
        """Whether the opposite neighbours of pixels lie on one surface: each near the other's tangent plane.

        Neighbours further off are of no use where nearer ones are far enough apart on the surface already.
        """
        first = row + k * step[0], column + k * step[1]
        second = row - k * step[0], column - k * step[1]
        with np.errstate(divide="ignore", invalid="ignore"):
            apart = self._rays_C[first] / inverse[first][:, None] - self._rays_C[second] / inverse[second][:, None]
            off = [np.abs(np.einsum("ij,ij->i", normals_C[at], apart)) for at in (first, second)]
        wide = (k - 1) / k * np.linalg.norm(apart, axis=1) >= 2.0 * self._settings.slit_m
        return (np.maximum(*off) < _COPLANAR_M) & ~(wide & (k > 1))
