"""Where the next foot should go and where the base must be to let it (PRE_OPT of Fig. 6)."""

from __future__ import annotations

import numpy as np

from surefoot.components.fsm.support_triangle import SupportTriangle
from surefoot.components.robot_model import LegKinematics
from surefoot.components.robot_model.rotation import matrix_of_rpy
from surefoot.config.fsm import Fsm
from surefoot.config.robot import Robot


class FootholdPlanner:
    """Targets, candidates and base poses from the present footholds, the local plane and the direction.

    Attributes:
        nominal_BF: (4, 3) feet in the base at the nominal joint configuration [m].
    """

    def __init__(self, robot: Robot, settings: Fsm):
        self._legs = LegKinematics(robot)
        self._settings = settings
        self.nominal_BF = self._legs.position(np.tile(robot.nominal.stand_q, (4, 1)))
        self._height = -float(self.nominal_BF[:, 2].mean())
        self._lowest = self._height - (robot.nominal.leg_height - settings.base_height_min_m)

    def centre(self, p_WF: np.ndarray, yaw: float) -> np.ndarray:
        """(2,) where the base would stand in the middle of the feet [m]."""
        return (p_WF[:, :2] - self.nominal_BF[:, :2] @ _turn(yaw).T).mean(axis=0)

    def targets(self, p_WF: np.ndarray, base_xy: np.ndarray, yaw: float, normal_W: np.ndarray) -> np.ndarray:
        """(4, 3) feet at the nominal joint configuration under a base at `base_xy`, on the local plane."""
        points = np.empty((4, 3))
        points[:, :2] = base_xy + self.nominal_BF[:, :2] @ _turn(yaw).T
        points[:, 2] = plane_height(p_WF, normal_W, points[:, :2])
        return points

    def pose(
        self, base_xy: np.ndarray, p_WF: np.ndarray, normal_W: np.ndarray, yaw: float, height: float | None = None
    ) -> np.ndarray:
        """(6,) base pose above the feet's plane, level with it: x, y, z [m], roll, pitch, yaw [rad]."""
        height = self._height if height is None else height
        z = plane_height(p_WF, normal_W, base_xy[None])[0] + height / normal_W[2]
        along = _turn(yaw).T @ normal_W[:2]
        pitch = np.arctan2(along[0], normal_W[2])
        roll = -np.arcsin(np.clip(along[1], -1.0, 1.0))
        return np.array([base_xy[0], base_xy[1], z, roll, pitch, yaw])

    def support_pose(
        self,
        leg: int,
        foothold_W: np.ndarray,
        p_WF: np.ndarray,
        normal_W: np.ndarray,
        yaw: float,
        com_B: np.ndarray,
        reserve_W: np.ndarray,
        depth_m: float = 0.0,
        length_m: float | None = None,
    ) -> np.ndarray | None:
        """Base pose that keeps the centre of mass inside the other three feet and reaches a foothold.

        The centre of mass goes to the point nearest to the foothold's side of the triangle shrunk by alpha
        and a little more. The base is lowered only as far as the reach demands.

        Args:
            leg: the leg to move.
            foothold_W: (3,) where to [m].
            p_WF: (4, 3) present feet [m].
            com_B: (3,) centre of mass from the trunk's origin, in the world's axes [m].
            reserve_W: (3,) what must be in reach beyond the foothold: the point probed in front of it [m].
            depth_m: how much lower than that its ground may lie, for the leg at its full length [m].
            length_m: what no leg may be longer than; by default what steps are planned with [m].

        Returns:
            (6,) the pose, or None when no height above the least reaches it.
        """
        settings = self._settings
        triangle = SupportTriangle(p_WF, leg)
        feet = p_WF.copy()
        feet[leg] = foothold_W
        wish = self.centre(feet, yaw) + com_B[:2]
        base_xy = triangle.nearest(wish, settings.margin_m + settings.margin_extra_m) - com_B[:2]
        carrying = np.delete(p_WF, leg, axis=0)
        height = self._height
        length_m = settings.leg_length_plan_m if length_m is None else length_m
        while height >= self._lowest - 1e-9:
            pose = self.pose(base_xy, carrying, normal_W, yaw, height)
            feet[leg] = foothold_W + reserve_W
            deep = feet.copy()
            deep[leg] -= depth_m * normal_W
            if (
                self.leg_lengths(pose, feet).max() <= length_m
                and self.leg_lengths(pose, deep)[leg] <= settings.leg_length_max_m
            ):
                return pose
            height -= settings.base_height_step_m
        return None

    def leg_lengths(self, pose: np.ndarray, p_WF: np.ndarray) -> np.ndarray:
        """(4,) thigh axis to foot centre [m]."""
        return self._legs.length((p_WF - pose[:3]) @ matrix_of_rpy(pose[3:]))

    def below_hip(self, leg: int, pose: np.ndarray, distance: float) -> np.ndarray:
        """(3,) point a distance [m] below a leg's nominal place under the base: where LEG_UP holds the foot."""
        p_BF = np.append(self.nominal_BF[leg, :2], -distance)
        return pose[:3] + matrix_of_rpy(pose[3:]) @ p_BF


def plane_height(p_WF: np.ndarray, normal_W: np.ndarray, xy: np.ndarray) -> np.ndarray:
    """(n,) height at xy (n, 2) of the plane with a normal through the middle of the feet [m]."""
    middle = p_WF.mean(axis=0)
    return middle[2] - (xy - middle[:2]) @ normal_W[:2] / normal_W[2]


def _turn(yaw: float) -> np.ndarray:
    c, s = np.cos(yaw), np.sin(yaw)
    return np.array([[c, -s], [s, c]])
