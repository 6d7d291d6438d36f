"""A leg in closed form: foot position, Jacobian and inverse, for any batch of legs at once.

The abduction axis is x, thigh and calf turn about y, and the zero posture is straight down. All
quantities are in the base frame B; arrays end in (..., 4, 3): legs FL, FR, RL, RR, then hip, thigh, calf
or x, y, z.
"""

from __future__ import annotations

import numpy as np

from surefoot.config.robot import LEGS, Robot


class LegKinematics:
    """Closed-form kinematics of the four legs of one robot.

    Attributes:
        hip_B: (4, 3) abduction axes in the base [m].
        thigh_y: (4,) signed lateral offset from abduction axis to thigh axis [m].
        l_thigh, l_calf: link lengths [m].
    """

    def __init__(self, robot: Robot):
        self.hip_B = np.array([robot.legs[leg].hip_p_B for leg in LEGS])
        self.thigh_y = np.array([robot.legs[leg].thigh_p_hip[1] for leg in LEGS])
        self.l_thigh = robot.thigh_length
        self.l_calf = robot.calf_length
        ranges = np.array(robot.position_range()).reshape(4, 3, 2)
        self.lower, self.upper = ranges[..., 0], ranges[..., 1]

    def position(self, q: np.ndarray) -> np.ndarray:
        """Foot centres in the base: (..., 4, 3) [m] of joint angles (..., 4, 3) [rad]."""
        c1, s1 = np.cos(q[..., 0]), np.sin(q[..., 0])
        x = -self.l_thigh * np.sin(q[..., 1]) - self.l_calf * np.sin(q[..., 1] + q[..., 2])
        r = self.l_thigh * np.cos(q[..., 1]) + self.l_calf * np.cos(q[..., 1] + q[..., 2])
        p = np.empty(q.shape)
        p[..., 0] = self.hip_B[:, 0] + x
        p[..., 1] = self.hip_B[:, 1] + c1 * self.thigh_y + s1 * r
        p[..., 2] = self.hip_B[:, 2] + s1 * self.thigh_y - c1 * r
        return p

    def jacobian(self, q: np.ndarray) -> np.ndarray:
        """d(foot centre)/d(joint angles) in the base: (..., 4, 3, 3) [m/rad]."""
        c1, s1 = np.cos(q[..., 0]), np.sin(q[..., 0])
        c2, s2 = np.cos(q[..., 1]), np.sin(q[..., 1])
        c23, s23 = np.cos(q[..., 1] + q[..., 2]), np.sin(q[..., 1] + q[..., 2])
        r = self.l_thigh * c2 + self.l_calf * c23
        dr2, dr3 = -self.l_thigh * s2 - self.l_calf * s23, -self.l_calf * s23
        jac = np.zeros((*q.shape, 3))
        jac[..., 0, 1] = -r
        jac[..., 0, 2] = -self.l_calf * c23
        jac[..., 1, 0] = -s1 * self.thigh_y + c1 * r
        jac[..., 1, 1] = s1 * dr2
        jac[..., 1, 2] = s1 * dr3
        jac[..., 2, 0] = c1 * self.thigh_y + s1 * r
        jac[..., 2, 1] = -c1 * dr2
        jac[..., 2, 2] = -c1 * dr3
        return jac

    def inverse(self, p_BF: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """Joint angles that put the feet at `p_BF`, knee bent backwards, inside the joint limits.

        Args:
            p_BF: (..., 4, 3) foot centres in the base [m].

        Returns:
            (..., 4, 3) joint angles [rad], and (..., 4) whether the point is within reach; where it is
            not, the angles are those of the nearest reachable length in the same direction.
        """
        d = p_BF - self.hip_B
        x, y, z = d[..., 0], d[..., 1], d[..., 2]
        yz2 = y * y + z * z
        r2 = yz2 - self.thigh_y**2
        r = np.sqrt(np.maximum(r2, 1e-6))
        q = np.empty(p_BF.shape)
        q[..., 0] = np.arctan2(z, y) - np.arctan2(-r, self.thigh_y)
        q[..., 0] = (q[..., 0] + np.pi) % (2 * np.pi) - np.pi
        length2 = x * x + r * r
        c3 = (length2 - self.l_thigh**2 - self.l_calf**2) / (2 * self.l_thigh * self.l_calf)
        lower, upper = np.cos(self.lower[:, 2]), np.cos(self.upper[:, 2])
        reachable = (c3 <= upper) & (c3 >= lower) & (r2 > 0.0)
        q[..., 2] = -np.arccos(np.clip(c3, lower, upper))
        knee = np.arctan2(self.l_calf * np.sin(q[..., 2]), self.l_thigh + self.l_calf * np.cos(q[..., 2]))
        q[..., 1] = np.arctan2(-x, r) - knee
        inside = (q >= self.lower) & (q <= self.upper)
        return np.clip(q, self.lower, self.upper), reachable & inside[..., :2].all(axis=-1)
