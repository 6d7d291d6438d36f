"""Images of scenes built for a test, as the component gets them, and the estimates of their times."""

import mujoco
import numpy as np

from surefoot.bus.messages import DepthFrame, StateEstimate
from surefoot.components.robot_model.rotation import matrix_of_rpy, quaternion_of
from surefoot.config.deployment import Deployment, Run
from surefoot.config.depth_camera import DepthCamera as Settings
from surefoot.config.hw import Hw
from surefoot.config.terrain import Terrain
from surefoot.hw.mujoco.depth_camera import DepthCamera
from surefoot.hw.mujoco.robot_body import TERRAIN_BITS
from surefoot.hw.mujoco.scene import build_scene

UP = np.array([0.0, 0.0, 1.0])


def deployment(vision=True, depth=None, kind="flat", clock="simulated"):
    return Deployment(
        run=Run(vision=vision, clock=clock), hw=Hw(depth=depth or Settings()), terrain=Terrain(kind=kind)
    )


def box(name, centre, half, pitch=0.0):
    """Adds a box to a scene; turned about y by `pitch`."""

    def add(spec):
        quat = quaternion_of(matrix_of_rpy(np.array([0.0, pitch, 0.0])))
        spec.worldbody.add_geom(
            name=name, type=mujoco.mjtGeom.mjGEOM_BOX, size=half, pos=centre, quat=quat, **TERRAIN_BITS
        )

    return add


class Sight:
    """A robot with a camera over some ground; it is put where a test wants it, nothing moves by itself."""

    def __init__(self, *boxes, depth=None, kind="flat", seed=0):
        self.deployment = deployment(depth=depth, kind=kind)
        self.robot = self.deployment.load_robot()

        def extra(spec):
            for add in boxes:
                add(spec)

        self.model, self.field = build_scene(self.deployment, self.robot, 0.6, extra)
        self.data = mujoco.MjData(self.model)
        self.data.qpos[7:19] = np.tile(self.robot.nominal.stand_q, 4)
        self._camera = DepthCamera(self.deployment.hw.depth, self.model, seed)

    def frame(self, t, p_WB, rpy=(0.0, 0.0, 0.0)):
        """The image from a pose."""
        self.data.qpos[:3], self.data.qpos[3:7] = p_WB, quaternion_of(matrix_of_rpy(np.array(rpy)))
        mujoco.mj_kinematics(self.model, self.data)
        image = self._camera.image(self.data)
        return DepthFrame(
            t=t, valid=True, p_BC=image.p_BC, quat_BC=image.quat_BC, fov=image.fov, depth_m=image.depth_m
        )


def estimate(t, p_WB, rpy=(0.0, 0.0, 0.0), tilt_std=0.0, **given):
    """An estimate of a pose; its tilt is known to `tilt_std` [rad]."""
    covariance = np.zeros((9, 9))
    covariance[6, 6] = covariance[7, 7] = tilt_std**2
    figures = {"covariance": covariance, "normal_W": UP, "valid": True} | given
    return StateEstimate(
        t=t, p_WB=np.array(p_WB, float), quat_WB=quaternion_of(matrix_of_rpy(np.array(rpy))), **figures
    )
