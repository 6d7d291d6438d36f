"""The robot's links from a base pose and joint angles: their shapes, and where its weight is."""

from __future__ import annotations

import numpy as np

from surefoot.bus.messages import LegStatus
from surefoot.components.robot_model import LegKinematics
from surefoot.components.robot_model.rotation import matrix_of
from surefoot.config.robot import JOINTS, LEGS, Primitive, Robot
from surefoot.tools.view.drawing import UPRIGHT, Drawing, Rgb, Shapes, rows
from surefoot.tools.view.palette import LEG_RGB

_LINK_RGB: dict[str, Rgb] = {
    "trunk": (70, 75, 84),
    "hip": (95, 100, 108),
    "thigh": (222, 122, 48),
    "calf": (80, 86, 94),
}
_ACROSS = np.array([np.sqrt(0.5), -np.sqrt(0.5), 0.0, 0.0])  # turns z to y: a cylinder across the leg


class RobotShapes:
    """The collision shapes of the robot's file: the trunk, and of each leg hip, thigh, calf and foot."""

    def __init__(self, robot: Robot):
        self._robot = robot
        self.legs = LegKinematics(robot)
        """Where the feet of other postures would be."""
        names = ("trunk", *(f"{leg}_{joint}" for leg in LEGS for joint in JOINTS))
        kinds = [name.rpartition("_")[2] for name in names]
        shapes = [robot.collision[kind] for kind in kinds]
        sides = np.array([1.0, *(_side(robot, leg) for leg in LEGS for _ in JOINTS)])
        self._centre = np.array([shape.center for shape in shapes]) * np.stack([sides**2, sides, sides**2], axis=1)
        size = np.array([_full_size(shape) for shape in shapes])
        rgb = np.array([_LINK_RGB[kind] for kind in kinds], np.uint8)
        self._box = box = np.array([shape.shape == "box" for shape in shapes])
        # The same objects in every drawing: what has not changed is not sent.
        self._box_size, self._box_rgb = size[box], rgb[box]
        self._cylinder_size, self._cylinder_rgb = size[~box], rgb[~box]
        self._foot_size = rows((2.0 * robot.foot.radius,) * 3, 4)
        links = [robot.trunk, *(getattr(robot.legs[leg], joint) for leg in LEGS for joint in JOINTS)]
        self._mass = np.array([link.mass for link in links])
        self._com = np.array([link.com for link in links])
        self._posture: tuple[np.ndarray, ...] = ()
        self._placed: tuple[np.ndarray, np.ndarray] | None = None

    def draw(self, p_WB: np.ndarray, quat_WB: np.ndarray, q: np.ndarray, leg_status: np.ndarray) -> Drawing:
        """The shapes of a posture; a foot has the colour of what its leg is at.

        Args:
            p_WB: (3,) trunk origin [m].
            quat_WB: (4,) its orientation.
            q: (12,) joint angles [rad].
            leg_status: (4,) a `LegStatus` for each leg.
        """
        p, quat = self._links(p_WB, quat_WB, q)
        centre = p + _turned(quat, self._centre)
        feet = p[3::3] + _turned(quat[3::3], np.tile([0.0, 0.0, -self._robot.calf_length], (4, 1)))
        foot_rgb = np.array([LEG_RGB[LegStatus(status)] for status in leg_status.tolist()], np.uint8)
        box = self._box
        across = _product(quat[~box], np.broadcast_to(_ACROSS, (int((~box).sum()), 4)))
        return {
            "robot/boxes": Shapes("box", centre[box], quat[box], self._box_size, self._box_rgb),
            "robot/cylinders": Shapes("cylinder", centre[~box], across, self._cylinder_size, self._cylinder_rgb),
            "robot/feet": Shapes("sphere", feet, rows(UPRIGHT, 4), self._foot_size, foot_rgb),
        }

    def com(self, p_WB: np.ndarray, quat_WB: np.ndarray, q: np.ndarray) -> np.ndarray:
        """(3,) centre of mass in the world [m] of a posture, by the robot's figures."""
        p, quat = self._links(p_WB, quat_WB, q)
        return self._mass @ (p + _turned(quat, self._com)) / self._mass.sum()

    def feet(self, p_WB: np.ndarray, R_WB: np.ndarray, q: np.ndarray) -> np.ndarray:
        """(n, 4, 3) foot centres [m] of n postures: base positions (n, 3), rotations (n, 3, 3), joints (n, 12)."""
        p_BF = self.legs.position(q.reshape(-1, 4, 3))
        return p_WB[:, None] + np.einsum("nij,nlj->nli", R_WB, p_BF)

    def _links(self, p_WB: np.ndarray, quat_WB: np.ndarray, q: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """(13, 3) origins and (13, 4) orientations of the trunk and of hip, thigh and calf of each leg."""
        posture = p_WB, quat_WB, q
        if self._placed is not None and all(a is b for a, b in zip(posture, self._posture, strict=True)):
            return self._placed
        angles = q.reshape(4, 3)
        thigh_B, knee_B = self.legs.joints(angles)
        R_WB = matrix_of(quat_WB)
        origins = np.stack([np.broadcast_to(self.legs.hip_B, (4, 3)), thigh_B, knee_B], axis=1)
        p = np.concatenate([p_WB[None], p_WB + origins.reshape(12, 3) @ R_WB.T])
        hip = _about(0, angles[:, 0])
        thigh = _product(hip, _about(1, angles[:, 1]))
        calf = _product(hip, _about(1, angles[:, 1] + angles[:, 2]))
        turned = np.stack([hip, thigh, calf], axis=1).reshape(12, 4)
        quat = np.concatenate([quat_WB[None], _product(np.broadcast_to(quat_WB, (12, 4)), turned)])
        self._posture, self._placed = posture, (p, quat)
        return self._placed


def _side(robot: Robot, leg: str) -> float:
    return float(np.sign(robot.legs[leg].thigh_p_hip[1]))


def _full_size(shape: Primitive) -> tuple[float, ...]:
    if shape.shape == "box":
        return shape.size
    radius, length = shape.size
    return 2.0 * radius, 2.0 * radius, length


def _about(axis: int, angle: np.ndarray) -> np.ndarray:
    """(n, 4) quaternions of turns about x (0) or y (1) by angles (n,) [rad]."""
    quat = np.zeros((len(angle), 4))
    quat[:, 0], quat[:, 1 + axis] = np.cos(0.5 * angle), np.sin(0.5 * angle)
    return quat


def _product(a: np.ndarray, b: np.ndarray) -> np.ndarray:
    """(n, 4) products of quaternions (n, 4)."""
    w, u, v, x = a[:, :1], a[:, 1:], b[:, 1:], b[:, :1]
    return np.hstack([w * x - (u * v).sum(axis=1, keepdims=True), w * v + x * u + _cross(u, v)])


def _turned(quat: np.ndarray, v: np.ndarray) -> np.ndarray:
    """(n, 3) vectors v (n, 3) turned by quaternions (n, 4)."""
    u = quat[:, 1:]
    across = 2.0 * _cross(u, v)
    return v + quat[:, :1] * across + _cross(u, across)


def _cross(a: np.ndarray, b: np.ndarray) -> np.ndarray:
    """(n, 3) vector products; `np.cross` costs five times as much at this length."""
    return a[:, _YZX] * b[:, _ZXY] - a[:, _ZXY] * b[:, _YZX]


_YZX, _ZXY = np.array([1, 2, 0]), np.array([2, 0, 1])
