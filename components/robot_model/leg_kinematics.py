"""A leg in closed form: foot position, Jacobian and inverse, for any batch of legs at once.

The abduction axis is x, thigh and calf turn about y, and the zero posture is straight down. All
quantities are in the base frame B; arrays end in (..., 4, 3): legs FL, FR, RL, RR, then hip, thigh, calf
or x, y, z.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from surefoot.config.robot import LEGS, Robot


class LegMotion(NamedTuple):
    """Where feet are and how they move, to second order, in the base.

    Attributes:
        position: (..., 4, 3) foot centres [m].
        jacobian: (..., 4, 3, 3) J = d(foot centre)/dq [m/rad], and inverse: (..., 4, 3, 3) of it.
        velocity_q: (..., 4, 3, 3) d(J dq)/dq at fixed dq [m/s/rad].
    """

    position: np.ndarray
    jacobian: np.ndarray
    inverse: np.ndarray
    velocity_q: np.ndarray


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

    def joints(self, q: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """Thigh axes and knees in the base, each (..., 4, 3) [m], of joint angles (..., 4, 3) [rad]."""
        c1, s1 = np.cos(q[..., 0]), np.sin(q[..., 0])
        thigh, knee = np.empty(q.shape), np.empty(q.shape)
        thigh[..., 0] = self.hip_B[:, 0]
        thigh[..., 1] = self.hip_B[:, 1] + c1 * self.thigh_y
        thigh[..., 2] = self.hip_B[:, 2] + s1 * self.thigh_y
        r = self.l_thigh * np.cos(q[..., 1])
        knee[..., 0] = thigh[..., 0] - self.l_thigh * np.sin(q[..., 1])
        knee[..., 1] = thigh[..., 1] + s1 * r
        knee[..., 2] = thigh[..., 2] - c1 * r
        return thigh, knee

    def length(self, p_BF: np.ndarray) -> np.ndarray:
        """(..., 4) thigh axis to foot centre [m] of feet (..., 4, 3) in the base, in reach or not."""
        d = p_BF - self.hip_B
        reach2 = np.maximum(d[..., 1] ** 2 + d[..., 2] ** 2 - self.thigh_y**2, 0.0)
        return np.sqrt(d[..., 0] ** 2 + reach2)

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

    def motion(self, q: np.ndarray, dq: np.ndarray) -> LegMotion:
        """Everything about legs at joint angles q (..., 4, 3) [rad] and velocities dq (..., 4, 3) [rad/s].

        In the frame that turns with the hip, the foot is at (x, d, -r) and its Jacobian has the rows
        (0, -r, r3'), (r, 0, 0), (d, -x, ...): that is what makes the inverse short.
        """
        l1, l2, d = self.l_thigh, self.l_calf, self.thigh_y
        angle = q.copy()
        angle[..., 2] += q[..., 1]
        cosine, sine = np.cos(angle), np.sin(angle)
        c1, s1 = cosine[..., 0], sine[..., 0]
        calf_z, calf_x = l2 * cosine[..., 2], l2 * sine[..., 2]
        r, x = l1 * cosine[..., 1] + calf_z, -l1 * sine[..., 1] - calf_x  # x is dr/dq2 too, -calf_x is dr/dq3
        y1, z1 = c1 * r - s1 * d, c1 * d + s1 * r
        p = np.empty(q.shape)
        np.add(self.hip_B[:, 0], x, out=p[..., 0])
        np.add(self.hip_B[:, 1], z1, out=p[..., 1])
        np.subtract(self.hip_B[:, 2], y1, out=p[..., 2])

        J = np.empty((*q.shape, 3))
        J[..., 0, 0] = 0.0
        np.negative(r, out=J[..., 0, 1])
        np.negative(calf_z, out=J[..., 0, 2])
        J[..., 1, 0], J[..., 2, 0] = y1, z1
        np.multiply(s1, x, out=J[..., 1, 1])
        np.multiply(s1, -calf_x, out=J[..., 1, 2])
        np.multiply(c1, -x, out=J[..., 2, 1])
        np.multiply(c1, calf_x, out=J[..., 2, 2])

        # Thigh and calf in the leg's plane: (-r, -calf_z; -x, calf_x) (dq2, dq3) = (vx, vz - d dq1).
        inverse = np.empty((*q.shape, 3))
        by_plane = 1.0 / (-r * calf_x - calf_z * x)
        inverse[..., 0, 0] = 0.0
        np.divide(c1, r, out=inverse[..., 0, 1])
        np.divide(s1, r, out=inverse[..., 0, 2])
        up_y, up_z = -s1 - d * inverse[..., 0, 1], c1 - d * inverse[..., 0, 2]
        thigh, calf = calf_z * by_plane, -r * by_plane
        np.multiply(calf_x, by_plane, out=inverse[..., 1, 0])
        np.multiply(thigh, up_y, out=inverse[..., 1, 1])
        np.multiply(thigh, up_z, out=inverse[..., 1, 2])
        np.multiply(x, by_plane, out=inverse[..., 2, 0])
        np.multiply(calf, up_y, out=inverse[..., 2, 1])
        np.multiply(calf, up_z, out=inverse[..., 2, 2])

        d1, d2 = dq[..., 0], dq[..., 1]
        d23 = d2 + dq[..., 2]
        rate = x * d2 - calf_x * dq[..., 2]  # dr/dt
        rate2 = -r * d2 - calf_z * dq[..., 2]
        rate3 = -calf_z * d23
        D = np.empty((*q.shape, 3))
        D[..., 0, 0] = 0.0
        np.negative(rate, out=D[..., 0, 1])
        np.multiply(calf_x, d23, out=D[..., 0, 2])
        np.subtract(c1 * rate, z1 * d1, out=D[..., 1, 0])
        np.add(y1 * d1, s1 * rate, out=D[..., 2, 0])
        c1_d1, s1_d1 = c1 * d1, s1 * d1
        np.add(c1_d1 * x, s1 * rate2, out=D[..., 1, 1])
        np.subtract(s1 * rate3, c1_d1 * calf_x, out=D[..., 1, 2])
        np.subtract(s1_d1 * x, c1 * rate2, out=D[..., 2, 1])
        np.add(s1_d1 * calf_x, c1 * rate3, out=D[..., 2, 2])
        np.negative(D[..., 2, 2], out=D[..., 2, 2])
        return LegMotion(p, J, inverse, D)

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
        q[..., 2] = -np.arccos(np.minimum(np.maximum(c3, lower), upper))
        knee = np.arctan2(self.l_calf * np.sin(q[..., 2]), self.l_thigh + self.l_calf * np.cos(q[..., 2]))
        q[..., 1] = np.arctan2(-x, r) - knee
        inside = (q >= self.lower) & (q <= self.upper)
        return np.minimum(np.maximum(q, self.lower), self.upper), reachable & inside[..., :2].all(axis=-1)
