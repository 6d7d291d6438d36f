"""The deployment's terrain as the simulator builds it, and moved as its truth says it has moved."""

from __future__ import annotations

import mujoco
import numpy as np

from surefoot.bus.messages import SimTruth
from surefoot.config.deployment import Deployment
from surefoot.hw.mujoco.scene import build_scene
from surefoot.tools.view.drawing import Drawing, Mesh, Shapes

_GEOM = mujoco.mjtGeom
_PLANE_M = 12.0  # of an endless plane that much is drawn
_PLANE_THICK_M = 0.01
_MOVED = 1e-4  # rad or m: what has moved less looks the same
_PLANE, _BOX, _MESH = (int(kind) for kind in (_GEOM.mjGEOM_PLANE, _GEOM.mjGEOM_BOX, _GEOM.mjGEOM_MESH))


class TerrainShapes:
    """Boxes, and one mesh of all loose stones."""

    def __init__(self, deployment: Deployment):
        """Build the terrain, without a robot; `hw.seed` draws what is left to chance as it did in the run."""
        self._model, _ = build_scene(deployment, None, deployment.ocp.friction)
        self._data = mujoco.MjData(self._model)
        mujoco.mj_kinematics(self._model, self._data)
        self._drawn: Drawing = {}

    def draw(self, truth: SimTruth | None) -> Drawing:
        """All of it; the very same objects as the last time if nothing has moved."""
        if truth is not None and self._has_moved(truth.terrain_q):
            self._data.qpos[:] = truth.terrain_q
            mujoco.mj_kinematics(self._model, self._data)
            self._drawn = {}
        if not self._drawn:
            self._drawn = self._boxes() | self._stones()
        return self._drawn

    def _has_moved(self, q: np.ndarray) -> bool:
        return len(q) == self._model.nq and bool(np.abs(q - self._data.qpos).max(initial=0.0) > _MOVED)

    def _boxes(self) -> Drawing:
        """All boxes, a plane as a thin one."""
        model, data = self._model, self._data
        geoms = np.flatnonzero(np.isin(model.geom_type, (_PLANE, _BOX)))
        plane = model.geom_type[geoms] == _PLANE
        quat = np.empty((len(geoms), 4))
        for each, geom in zip(quat, geoms, strict=True):
            mujoco.mju_mat2Quat(each, data.geom_xmat[geom])
        size, p = 2.0 * model.geom_size[geoms], data.geom_xpos[geoms].copy()
        size[plane] = _PLANE_M, _PLANE_M, _PLANE_THICK_M
        p[plane, 2] -= 0.5 * _PLANE_THICK_M
        rgb = (255.0 * model.geom_rgba[geoms, :3]).astype(np.uint8)
        return {"terrain/boxes": Shapes("box", p, quat, size, rgb)}

    def _stones(self) -> Drawing:
        """All meshes as one."""
        model, data = self._model, self._data
        geoms = np.flatnonzero(model.geom_type == _MESH)
        if not len(geoms):
            return {}
        vertices: list[np.ndarray] = []
        faces: list[np.ndarray] = []
        count = 0
        for geom in geoms:
            mesh = model.geom_dataid[geom]
            first, n = model.mesh_vertadr[mesh], model.mesh_vertnum[mesh]
            begin, m = model.mesh_faceadr[mesh], model.mesh_facenum[mesh]
            turned = model.mesh_vert[first : first + n] @ data.geom_xmat[geom].reshape(3, 3).T
            vertices.append(turned + data.geom_xpos[geom])
            faces.append(model.mesh_face[begin : begin + m] + count)
            count += n
        red, green, blue = (int(255.0 * part) for part in model.geom_rgba[geoms[0], :3])
        return {"terrain/stones": Mesh(np.concatenate(vertices), np.concatenate(faces), (red, green, blue))}
