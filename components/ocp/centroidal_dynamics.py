"""Centroidal dynamics of a legged robot and their exact linearisation, batched over the nodes.

State x, as a tangent of 24: normalised momentum h/m (linear, angular about the centre of mass, in W) 0:6,
base position in W 6:9, base rotation R exp(phi) 9:12, joints 12:24. Inputs of a leg are three numbers: its
contact force in W while it stands (its foot velocity is zero), its foot velocity in W while it swings (its
force is zero), so eq. (3) is projected out and 12 inputs remain of the paper's 24.

Generalised velocities v (18: base linear and angular in B, joints) are lifted: carried along as unknowns
with S v = (m h; w), S = [A_g; J_feet], and corrected by the linearisation; v[6:] are the paper's dq_j.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import pinocchio as pin

from surefoot.components.robot_model import LegKinematics, build_model
from surefoot.components.robot_model.rotation import skew
from surefoot.config.robot import GRAVITY, Robot

NX, NU, NV = 24, 12, 18
MOMENTUM, POSITION, ROTATION, JOINTS = slice(0, 6), slice(6, 9), slice(9, 12), slice(12, 24)
_W, _ONE = slice(24, 36), 36
_EYE3 = np.eye(3)


@dataclass
class Trajectory:
    """An iterate: states at N+1 nodes, inputs and lifted velocities at N nodes.

    Attributes:
        h: (N+1, 6) normalised momentum [m/s, m^2/s].
        p_WB: (N+1, 3) [m].
        R_WB: (N+1, 3, 3).
        q: (N+1, 4, 3) joints [rad].
        force_W: (N, 4, 3) [N]; zero where a leg swings.
        foot_velocity_W: (N, 4, 3) [m/s]; zero where a leg stands.
        v: (N, 18) generalised velocities.
    """

    h: np.ndarray
    p_WB: np.ndarray
    R_WB: np.ndarray
    q: np.ndarray
    force_W: np.ndarray
    foot_velocity_W: np.ndarray
    v: np.ndarray


@dataclass
class Linearisation:
    """x_{k+1} = A x_k + B u_k + c in deviations from an iterate, and what costs need of it.

    Attributes:
        A: (N, 24, 24), B: (N, 24, 12), c: (N, 24) defects.
        v_x: (N, 18, 24), v_u: (N, 18, 12), v_c: (N, 18) sensitivity of the lifted velocities.
        p_BF: (N, 4, 3) feet in the base [m]; p_WF: (N, 4, 3) in the world.
        foot_rotation: (N, 4, 3, 3) d p_WF / d phi; foot_joint: (N, 4, 3, 3) d p_WF / d q of the leg.
        com_W: (N, 3) [m]; com_x: (N, 3, 24) its derivative.
    """

    A: np.ndarray
    B: np.ndarray
    c: np.ndarray
    v_x: np.ndarray
    v_u: np.ndarray
    v_c: np.ndarray
    p_BF: np.ndarray
    p_WF: np.ndarray
    foot_rotation: np.ndarray
    foot_joint: np.ndarray
    com_W: np.ndarray
    com_x: np.ndarray


class CentroidalDynamics:
    """The dynamics of one robot (Orin et al. 2013), explicit Euler between nodes."""

    def __init__(self, robot: Robot):
        self._model = build_model(robot)
        self._model.armature[:] = 0.0  # rotors add to joint inertia, not to the momentum of the links
        self._data = self._model.createData()
        self._legs = LegKinematics(robot)
        self.mass = robot.mass
        self._zero = np.zeros(NV)
        self._gravity = np.array([0.0, 0.0, -GRAVITY])

    def foot_velocity(self, R_WB: np.ndarray, q: np.ndarray, v: np.ndarray) -> np.ndarray:
        """World velocity of the feet (..., 4, 3) [m/s]."""
        p_BF, J = self._legs.position(q), self._legs.jacobian(q)
        return self._body_velocity(p_BF, J, v) @ _transpose(R_WB)

    def linearise(
        self,
        iterate: Trajectory,
        contact: np.ndarray,
        dt: float,
        normal_W: np.ndarray,
        swing_height_rate: np.ndarray,
        swing_height_gain: float,
        swing_height_ref: np.ndarray,
    ) -> Linearisation:
        """Linearise about an iterate.

        Args:
            iterate: N+1 states, N inputs.
            contact: (N, 4) stance legs.
            dt: interval [s].
            normal_W: (3,) surface normal; along it a swing foot follows
                v.n = rate - gain (p.n - ref), eq. (3) with the position error fed back.
            swing_height_rate: (N, 4) reference speed along the normal [m/s].
            swing_height_gain: [1/s].
            swing_height_ref: (N, 4) reference of p.n [m].
        """
        N = len(iterate.v)
        R, q, v = iterate.R_WB[:N], iterate.q[:N], iterate.v
        Rt = _transpose(R)
        A_g, h_q, com = self._centroidal(iterate.p_WB[:N], R, q, v)
        p_BF, J = self._legs.position(q), self._legs.jacobian(q)
        omega = v[:, 3:6]
        u_B = self._body_velocity(p_BF, J, v)
        arm = p_BF @ Rt
        p_WF = iterate.p_WB[:N, None] + arm
        R4 = R[:, None]
        foot_rotation = -(R4 @ skew(p_BF))
        foot_joint = R4 @ J

        w, w_x, w_free = self._swing(
            iterate, contact, normal_W, swing_height_rate, swing_height_gain, swing_height_ref, p_WF,
            foot_rotation, foot_joint,
        )  # fmt: skip
        J_inv = _inverse3(J)
        leg_base = np.empty((N, 4, 3, 6))  # Y = [I, -[y]x]: base twist to foot velocity in B
        leg_base[..., :3] = _EYE3
        leg_base[..., 3:] = -skew(p_BF)

        # Foot rows in B, of [x (24), w (12), 1]: filled per leg where they are not zero.
        foot = np.zeros((N, 4, 3, 37))
        foot[..., ROTATION] = skew(u_B)
        turning = skew(omega)[:, None] @ J + self._legs_velocity_derivative(q, v)
        for leg in range(4):
            own_q = slice(12 + 3 * leg, 15 + 3 * leg)
            own_w = slice(24 + 3 * leg, 27 + 3 * leg)
            foot[:, leg, :, own_q] = -turning[:, leg]
            foot[:, leg, :, own_w] = Rt @ w_free[:, leg]
        foot[..., :24] += Rt[:, None] @ w_x
        foot[..., _ONE] = (w @ R) - u_B

        momentum = np.zeros((N, 6, 37))
        momentum[..., MOMENTUM] = self.mass * np.eye(6)
        momentum[..., 9:24] = -h_q[:, :, 3:]
        momentum[..., _ONE] = self.mass * iterate.h[:N] - (A_g @ v[..., None])[..., 0]

        J_foot = J_inv @ foot
        J_base = (J_inv @ leg_base).reshape(N, 12, 6)
        A_legs = A_g[:, :, 6:]
        K = A_g[:, :, :6] - A_legs @ J_base
        right = momentum - A_legs @ J_foot.reshape(N, 12, 37)
        v_all = np.empty((N, NV, 37))
        v_all[:, :6] = np.linalg.solve(K, right)
        v_all[:, 6:] = J_foot.reshape(N, 12, 37) - J_base @ v_all[:, :6]

        com_x = np.zeros((N, 3, NX))
        com_x[..., POSITION] = _EYE3
        com_x[..., 9:24] = A_g[:, :3, 3:] / self.mass

        A, B, c = self._assemble(iterate, contact, dt, v_all, arm, com, com_x, p_WF, foot_rotation, foot_joint)
        stance = np.repeat(contact, 3, axis=1)
        v_u = np.where(stance[:, None, :], 0.0, v_all[..., _W])
        return Linearisation(
            A=A, B=B, c=c, v_x=v_all[..., :24], v_u=v_u, v_c=v_all[..., _ONE], p_BF=p_BF, p_WF=p_WF,
            foot_rotation=foot_rotation, foot_joint=foot_joint, com_W=com, com_x=com_x,
        )  # fmt: skip

    def _centroidal(self, p_WB, R, q, v):
        """A_g (N, 6, 18), d(A_g v)/dq (N, 6, 18) and the centre of mass (N, 3), one Pinocchio pass a node."""
        N = len(v)
        A_g, h_q, com = np.empty((N, 6, NV)), np.empty((N, 6, NV)), np.empty((N, 3))
        configuration = np.empty((N, 19))
        configuration[:, :3] = p_WB
        configuration[:, 3:7] = _quaternions(R)
        configuration[:, 7:] = q.reshape(N, 12)
        derivatives = pin.computeCentroidalDynamicsDerivatives
        model, data, zero = self._model, self._data, self._zero
        for k in range(N):
            dh_dq, _, _, A = derivatives(model, data, configuration[k], v[k], zero)
            A_g[k], h_q[k], com[k] = A, dh_dq, data.com[0]
        return A_g, h_q, com

    def _swing(self, iterate, contact, normal, rate, gain, reference, p_WF, foot_rotation, foot_joint):
        """Foot velocities w (N, 4, 3), and how they depend on the state and on the free inputs.

        A swing foot's velocity along the normal is prescribed; its input along the normal is a dummy.
        """
        N = len(contact)
        swing = ~contact
        tangential = _EYE3 - np.outer(normal, normal)
        along = rate - gain * (p_WF @ normal - reference)
        w = iterate.foot_velocity_W @ tangential + along[..., None] * normal
        w *= swing[..., None]
        w_free = swing[..., None, None] * tangential
        w_x = np.zeros((N, 4, 3, NX))
        projector = (-gain * swing)[..., None, None] * np.outer(normal, normal)
        w_x[..., POSITION] = projector
        w_x[..., ROTATION] = projector @ foot_rotation
        own = projector @ foot_joint
        for leg in range(4):
            w_x[:, leg, :, 12 + 3 * leg : 15 + 3 * leg] = own[:, leg]
        return w, w_x, w_free

    def _assemble(self, iterate, contact, dt, v_all, arm, com, com_x, p_WF, foot_rotation, foot_joint):
        """A, B and c of the explicit Euler step."""
        N = len(v_all)
        R, v, force = iterate.R_WB[:N], iterate.v, iterate.force_W * contact[..., None]
        full = np.zeros((N, NX, 37))  # of [x, w, 1]
        full[:, range(NX), range(NX)] = 1.0
        lever = p_WF - com[:, None]
        # Angular momentum rate: sum (p_i - c) x f_i.
        f_skew = skew(force) * (-dt / self.mass)
        total = f_skew.sum(axis=1)
        full[:, 3:6, POSITION] += total
        full[:, 3:6, ROTATION] += (f_skew @ foot_rotation).sum(axis=1)
        by_joint = f_skew @ foot_joint
        for leg in range(4):
            full[:, 3:6, 12 + 3 * leg : 15 + 3 * leg] += by_joint[:, leg]
        full[:, 3:6, :24] -= total @ com_x
        # Base pose and joints.
        full[:, POSITION] += dt * (R @ v_all[:, :3])
        full[:, POSITION, ROTATION] -= dt * (R @ skew(v[:, :3]))
        # phi' = exp(-omega dt) phi + dt J_r(omega dt) d omega, J_r by its series (1e-6 at 0.3 rad).
        turn = skew(v[:, 3:6] * dt)
        angle2 = ((v[:, 3:6] * dt) ** 2).sum(axis=1)[:, None, None]
        right = _EYE3 - (0.5 - angle2 / 24.0) * turn + (1.0 / 6.0 - angle2 / 120.0) * (turn @ turn)
        turned = exp_rotations(v[:, 3:6] * dt)
        full[:, ROTATION] += dt * (right @ v_all[:, 3:6])
        full[:, ROTATION, ROTATION] += _transpose(turned) - _EYE3
        full[:, JOINTS] += dt * v_all[:, 6:]

        stance = np.repeat(contact, 3, axis=1)
        B = np.where(stance[:, None, :], 0.0, full[..., _W])
        by_force = np.zeros((N, 6, 4, 3))
        by_force[:, :3] = np.broadcast_to((dt / self.mass) * _EYE3[:, None, :], (N, 3, 4, 3))
        by_force[:, 3:] = (dt / self.mass) * skew(lever).transpose(0, 2, 1, 3)
        B[:, :6] += np.where(stance[:, None, :], by_force.reshape(N, 6, 12), 0.0)

        c = full[..., _ONE]
        c[:, :3] += iterate.h[:N, :3] - iterate.h[1:, :3]
        c[:, :3] += dt * (force.sum(axis=1) / self.mass + self._gravity)
        moment = (skew(lever) @ force[..., None])[..., 0].sum(axis=1)
        c[:, 3:6] += iterate.h[:N, 3:] - iterate.h[1:, 3:] + (dt / self.mass) * moment
        c[:, POSITION] += iterate.p_WB[:N] - iterate.p_WB[1:] + dt * (R @ v[:, :3, None])[..., 0]
        c[:, ROTATION] += log_rotations(_transpose(iterate.R_WB[1:]) @ R @ turned)
        c[:, JOINTS] += (iterate.q[:N] - iterate.q[1:]).reshape(N, 12) + dt * v[:, 6:]
        return full[..., :24], B, c

    @staticmethod
    def _body_velocity(p_BF, J, v):
        """Foot velocities expressed in B: v_lin + omega x y + J dq, (..., 4, 3)."""
        dq = v[..., 6:].reshape(*v.shape[:-1], 4, 3, 1)
        return v[..., None, :3] - (skew(p_BF) @ v[..., None, 3:6, None])[..., 0] + (J @ dq)[..., 0]

    def _legs_velocity_derivative(self, q: np.ndarray, v: np.ndarray) -> np.ndarray:
        """d(J dq)/dq of each leg at fixed dq, in B: (N, 4, 3, 3)."""
        legs = self._legs
        dq = v[:, 6:].reshape(-1, 4, 3)
        c1, s1 = np.cos(q[..., 0]), np.sin(q[..., 0])
        q23 = q[..., 1] + q[..., 2]
        r = legs.l_thigh * np.cos(q[..., 1]) + legs.l_calf * np.cos(q23)
        r2 = -legs.l_thigh * np.sin(q[..., 1]) - legs.l_calf * np.sin(q23)
        r3, r33 = -legs.l_calf * np.sin(q23), -legs.l_calf * np.cos(q23)
        d1, d2, d3 = dq[..., 0], dq[..., 1], dq[..., 2]
        rate = r2 * d2 + r3 * d3
        rate2 = -r * d2 + r33 * d3  # d(rate)/dq2
        rate3 = r33 * (d2 + d3)  # d(rate)/dq3
        y1 = -s1 * legs.thigh_y + c1 * r
        z1 = c1 * legs.thigh_y + s1 * r
        D = np.zeros((*q.shape, 3))
        D[..., 0, 1] = -rate
        D[..., 0, 2] = -r3 * (d2 + d3)
        D[..., 1, 0] = -z1 * d1 + c1 * rate
        D[..., 1, 1] = c1 * r2 * d1 + s1 * rate2
        D[..., 1, 2] = c1 * r3 * d1 + s1 * rate3
        D[..., 2, 0] = y1 * d1 + s1 * rate
        D[..., 2, 1] = s1 * r2 * d1 - c1 * rate2
        D[..., 2, 2] = s1 * r3 * d1 - c1 * rate3
        return D


def exp_rotations(phi: np.ndarray) -> np.ndarray:
    """(N, 3, 3) rotations of (N, 3) rotation vectors."""
    angle2 = (phi * phi).sum(axis=-1)
    angle = np.sqrt(angle2)
    a = np.sinc(angle / np.pi)
    half = np.sinc(0.5 * angle / np.pi)
    K = skew(phi)
    return _EYE3 + a[:, None, None] * K + (0.5 * half * half)[:, None, None] * (K @ K)


def log_rotations(R: np.ndarray) -> np.ndarray:
    """(N, 3) rotation vectors of (N, 3, 3) rotations of less than pi."""
    quat = _quaternions(R)
    length = np.sqrt((quat[:, :3] ** 2).sum(axis=1))
    scale = np.where(length < 1e-9, 2.0, 2.0 * np.arctan2(length, quat[:, 3]) / np.maximum(length, 1e-12))
    return scale[:, None] * quat[:, :3]


def _quaternions(R: np.ndarray) -> np.ndarray:
    """(N, 4) quaternions (x, y, z, w), w > 0, of rotations of less than pi."""
    diagonal = R[:, [0, 1, 2], [0, 1, 2]]
    trace = diagonal.sum(axis=1)
    quat = np.empty((len(R), 4))
    w = 0.5 * np.sqrt(np.maximum(1.0 + trace, 1e-12))
    quat[:, 3] = w
    scale = 0.25 / w
    quat[:, 0] = scale * (R[:, 2, 1] - R[:, 1, 2])
    quat[:, 1] = scale * (R[:, 0, 2] - R[:, 2, 0])
    quat[:, 2] = scale * (R[:, 1, 0] - R[:, 0, 1])
    return quat


def _transpose(R: np.ndarray) -> np.ndarray:
    return R.swapaxes(-1, -2)


def _inverse3(M: np.ndarray) -> np.ndarray:
    """Inverses of (..., 3, 3) matrices by cofactors."""
    a, b, c = M[..., 0, :], M[..., 1, :], M[..., 2, :]
    inverse = np.empty(M.shape)
    for column, (p, q) in enumerate(((b, c), (c, a), (a, b))):
        for row in range(3):
            i, j = (row + 1) % 3, (row + 2) % 3
            inverse[..., row, column] = p[..., i] * q[..., j] - p[..., j] * q[..., i]
    determinant = (a * inverse[..., :, 0]).sum(axis=-1)
    return inverse / determinant[..., None, None]
