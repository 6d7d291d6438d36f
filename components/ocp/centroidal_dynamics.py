"""Eq. (1c): centroidal dynamics of a legged robot (Sec. II-B.2), exactly linearised, batched over the nodes.

State and inputs are those of `layout`. Inputs of a leg are three numbers: its contact force in W while it
stands (its foot velocity is zero), its foot velocity in W while it swings (its force is zero), so eq. (3),
that is eq. (1d), is projected out and 12 inputs remain of the paper's 24.

Generalised velocities v (18: base linear and angular in B, joints) are lifted: carried along as unknowns
with S v = (m h; w), S = [A_g; J_feet], and corrected by the linearisation; v[6:] are the paper's dq_j.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import pinocchio as pin

from surefoot.components.ocp.layout import (
    CONFIGURATION,
    JOINTS,
    MOMENTUM,
    NV,
    NX,
    ONE,
    POSITION,
    ROTATION,
    U_JOINTS,
    U_MOMENTUM,
    U_POSITION,
    U_ROTATION,
    WIDTH,
    U,
    X,
    diagonals,
    leg_blocks,
)
from surefoot.components.robot_model import LegKinematics, build_model
from surefoot.components.robot_model.rotation import skew
from surefoot.components.robot_model.rotations import exp_rotations_and_jacobians, log_rotations, quaternions_of
from surefoot.config.robot import GRAVITY, Robot

_EYE3 = np.eye(3)
_BASE, _ROWS = slice(0, 6), slice(6, 6 + WIDTH)


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


class Linearisation:
    """(x_{k+1}, 1) = F_k (u_k, x_k, 1) in deviations from an iterate, and what costs need of it.

    Its arrays are allocated once: they hold until the dynamics are linearised again.

    Attributes:
        F: (N, 25, 37) dynamics; A: (N, 24, 24), B: (N, 24, 12), c: (N, 24) defects are views of it.
        V: (N, 18, 37) lifted velocities; v_x: (N, 18, 24), v_u: (N, 18, 12), v_c: (N, 18) are views of it.
        p_WF: (N, 4, 3) feet [m]; com_W: (N, 3) centre of mass [m].
        place_x: (N, 5, 3, 18) derivatives of the four feet and the centre of mass in the configuration.
    """

    def __init__(self, N: int):
        self.F = np.zeros((N, NX + 1, WIDTH))
        self.F[:, MOMENTUM, U_MOMENTUM] = np.eye(6)
        self.F[:, NX, ONE] = 1.0
        self.A, self.B, self.c = self.F[:, :NX, X], self.F[:, :NX, U], self.F[:, :NX, ONE]
        self.V = np.zeros((N, NV, WIDTH))
        self.v_x, self.v_u, self.v_c = self.V[..., X], self.V[..., U], self.V[..., ONE]
        self.p_WF, self.com_W = np.empty((N, 4, 3)), np.empty((N, 3))
        self.place_x = np.zeros((N, 5, 3, NV))
        self.place_x[..., :3] = _EYE3

    @property
    def com_x(self) -> np.ndarray:
        """(N, 3, 18) derivative of the centre of mass in the configuration."""
        return self.place_x[:, 4]


class CentroidalDynamics:
    """The dynamics of one robot (Orin et al. 2013) over N intervals, explicit Euler between nodes.

    Its arrays are allocated once, and what is zero or constant in them is written once.
    """

    def __init__(self, robot: Robot, N: int):
        self._model = build_model(robot)
        self._model.armature[:] = 0.0  # rotors add to joint inertia, not to the momentum of the links
        self._data = self._model.createData()
        self._legs = LegKinematics(robot)
        self.N = N
        self.mass = robot.mass
        self._zero = np.zeros(NV)
        self._gravity = np.array([0.0, 0.0, -GRAVITY])
        self._configuration = np.empty((N, 19))
        self._A_g = np.empty((N, 6, NV))
        linear = self._linear = Linearisation(N)
        self._feet_x = linear.place_x[:, :4]
        self._feet_x_joints = leg_blocks(self._feet_x.reshape(N, 12, NV)[..., 6:])
        # Rows of S v = (m h; w), of the base's twist and of (u, x, 1); the feet's are in B.
        self._momentum_rows, self._foot_rows = np.zeros((N, 6, 6 + WIDTH)), np.zeros((N, 4, 3, 6 + WIDTH))
        self._momentum_rows[..., _ROWS][..., U_MOMENTUM] = self.mass * np.eye(6)
        self._foot_rows[..., :3] = _EYE3
        own = self._foot_rows.reshape(N, 12, 6 + WIDTH)[..., _ROWS]
        self._foot_rows_u, self._foot_rows_joints = leg_blocks(own[..., U]), leg_blocks(own[..., U_JOINTS])
        self._leg_rows, self._base_rows = np.empty((N, 12, 6 + WIDTH)), np.empty((N, 6, 6 + WIDTH))
        # Angular momentum rate: sum (p_i - c) x f_i, side by side for the legs: (N, 3, 12).
        self._force_skew = np.zeros((N, 3, 4, 3))
        self._force_u = _by_leg(linear.F[:, :3, U])
        self._lever_u = _by_leg(linear.F[:, 3:6, U])
        rows = linear.F[:, 6:NX]
        self._position_diagonal = diagonals(rows[:, :3, U_POSITION])
        self._joint_diagonal = diagonals(rows[:, 6:, U_JOINTS])

    @property
    def F(self) -> np.ndarray:
        """(N, 25, 37) where every linearisation is written."""
        return self._linear.F

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
        """Linearise about an iterate; the result holds until the next call.

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
        linear, N = self._linear, self.N
        p_WB, R, v = iterate.p_WB[:N], iterate.R_WB[:N], iterate.v
        Rt, R_legs = _transpose(R), R[:, None]
        Rt_legs = Rt[:, None]
        dq = v[:, 6:].reshape(N, 4, 3)
        legs = self._legs.motion(iterate.q[:N], dq)

        # Y = [I, -[y]x]: base twist to foot velocity in B.
        twist, lever = self._foot_rows[..., _BASE], self._foot_rows[..., 3:6]
        skew(-legs.position, out=lever)
        np.add(p_WB[:, None], legs.position @ Rt, out=linear.p_WF)
        np.matmul(R_legs, lever, out=self._feet_x[..., 3:6])
        self._feet_x_joints[...] = R_legs @ legs.jacobian
        self._centroidal(p_WB, R, iterate.q[:N], v)

        # Feet: Y v_base + J dq = R' w.
        w, w_u, w_height = self._swing(
            iterate, contact, normal_W, swing_height_rate, swing_height_gain, swing_height_ref
        )
        foot_velocity = (twist @ v[:, None, :6, None] + legs.jacobian @ dq[..., None])[..., 0]
        foot_rows = self._foot_rows[..., _ROWS]
        self._foot_rows_u[...] = Rt_legs @ w_u
        np.matmul(Rt_legs @ w_height, self._feet_x, out=foot_rows[..., CONFIGURATION])
        foot_rows[..., U_ROTATION] += skew(foot_velocity)
        self._foot_rows_joints -= skew(v[:, None, 3:6]) @ legs.jacobian + legs.velocity_q
        np.subtract(w @ R, foot_velocity, out=foot_rows[..., ONE])

        # Momentum: A_b v_base + A_l dq = m h.
        A_g, momentum_rows = self._A_g, self._momentum_rows
        momentum_rows[..., _BASE] = A_g[..., :6]
        momentum_rows[..., _ROWS][..., ONE] = self.mass * iterate.h[:N] - (A_g @ v[..., None])[..., 0]

        # Elimination of the legs, then of the base: (A_b - A_l J^-1 Y) v_base = m h - A_l J^-1 R' w.
        leg_rows, base_rows = self._leg_rows, self._base_rows
        np.matmul(legs.inverse, self._foot_rows, out=leg_rows.reshape(self._foot_rows.shape))
        np.matmul(A_g[..., 6:], leg_rows, out=base_rows)
        np.subtract(momentum_rows, base_rows, out=base_rows)
        v_base, v_legs = linear.V[:, :6], linear.V[:, 6:]
        np.matmul(np.linalg.inv(base_rows[..., _BASE]), base_rows[..., _ROWS], out=v_base)
        np.matmul(leg_rows[..., _BASE], v_base, out=v_legs)
        np.subtract(leg_rows[..., _ROWS], v_legs, out=v_legs)

        self._euler_step(iterate, contact, dt)
        return linear

    def _centroidal(self, p_WB: np.ndarray, R: np.ndarray, q: np.ndarray, v: np.ndarray) -> None:
        """A_g, -d(A_g v)/dq (N, 6, 18) and the centre of mass with its derivative; one Pinocchio pass a node."""
        configuration, A_g = self._configuration, self._A_g
        configuration[:, :3] = p_WB
        configuration[:, 3:7] = quaternions_of(R)
        configuration[:, 7:] = q.reshape(-1, 12)
        momentum_q = self._momentum_rows[..., _ROWS][..., CONFIGURATION]
        derivatives = pin.computeCentroidalDynamicsDerivatives
        model, data, zero = self._model, self._data, self._zero
        for at_q, at_v, out_A, out_h_q in zip(configuration, v, A_g, momentum_q, strict=True):
            h_q, _, _, A = derivatives(model, data, at_q, at_v, zero)
            out_A[:], out_h_q[:] = A, h_q
        np.negative(momentum_q, out=momentum_q)
        com_x = self._linear.com_x
        np.divide(A_g[:, :3, 3:], self.mass, out=com_x[..., 3:])
        # The base turns the centre of mass about its origin: d c / d phi = -[c - p]x R.
        turning = com_x[..., 3:6] @ _transpose(R)
        com_W = self._linear.com_W
        com_W[:, 0], com_W[:, 1], com_W[:, 2] = turning[:, 1, 2], turning[:, 2, 0], turning[:, 0, 1]
        com_W += p_WB

    def _swing(self, iterate, contact, normal, rate, gain, reference):
        """Foot velocities w (N, 4, 3), and their derivatives in the inputs and in the foot's place (N, 4, 3, 3).

        A swing foot's velocity along the normal is prescribed; its input along the normal is a dummy.
        """
        swing = 1.0 - contact
        upright = normal[:, None] * normal
        tangential = _EYE3 - upright
        along = swing * (rate - gain * (self._linear.p_WF @ normal - reference))
        w = (swing[..., None] * iterate.foot_velocity_W) @ tangential + along[..., None] * normal
        swing = swing[..., None, None]
        return w, swing * tangential, swing * (-gain * upright)

    def _euler_step(self, iterate: Trajectory, contact: np.ndarray, dt: float) -> None:
        """F of x_{k+1} = x_k + dt f(x_k, u_k)."""
        linear, N, per_mass = self._linear, self.N, dt / self.mass
        F, V, c = linear.F, linear.V, linear.c
        h, p, R, q, v = iterate.h, iterate.p_WB, iterate.R_WB[:N], iterate.q, iterate.v
        stance = contact[..., None] * per_mass
        impulse = iterate.force_W * stance

        # Momentum: forces and gravity; sum (p_i - c) x f_i.
        self._force_u[...] = stance[..., None] * _EYE3
        c[:, :3] = h[:N, :3] - h[1:, :3] + impulse.sum(axis=1) + dt * self._gravity
        lever = linear.p_WF - linear.com_W[:, None]
        lever_x = linear.place_x[:, :4] - linear.place_x[:, 4:]
        skew(stance * lever, out=self._lever_u)
        skew(-impulse, out=self._force_skew.transpose(0, 2, 1, 3))
        by_force = self._force_skew.reshape(N, 3, 12)
        np.matmul(by_force, lever_x.reshape(N, 12, NV), out=F[:, 3:6, CONFIGURATION])
        moment = (by_force @ lever.reshape(N, 12, 1))[..., 0]
        c[:, 3:6] = h[:N, 3:] - h[1:, 3:] + moment

        # Base position: p + dt R v.
        velocity_W = dt * R
        np.matmul(velocity_W, V[:, :3], out=F[:, POSITION])
        self._position_diagonal += 1.0
        F[:, POSITION, U_ROTATION] -= velocity_W @ skew(v[:, :3])
        c[:, POSITION] += p[:N] - p[1:] + (velocity_W @ v[:, :3, None])[..., 0]

        # Base rotation: phi' = exp(-omega dt) phi + dt J_r(omega dt) d omega.
        turned, right = exp_rotations_and_jacobians(dt * v[:, 3:6])
        np.matmul(dt * right, V[:, 3:6], out=F[:, ROTATION])
        F[:, ROTATION, U_ROTATION] += _transpose(turned)
        c[:, ROTATION] += log_rotations(_transpose(iterate.R_WB[1:]) @ (R @ turned))

        # Joints: q + dt dq.
        np.multiply(dt, V[:, 6:], out=F[:, JOINTS])
        self._joint_diagonal += 1.0
        c[:, JOINTS] += (q[:N] - q[1:]).reshape(N, 12) + dt * v[:, 6:]


def _by_leg(rows: np.ndarray) -> np.ndarray:
    """(N, 3, 12) rows as (N, 4, 3, 3), a view."""
    return rows.reshape(len(rows), 3, 4, 3).transpose(0, 2, 1, 3)


def _transpose(R: np.ndarray) -> np.ndarray:
    return R.swapaxes(-1, -2)
