"""The estimator's process: 500 Hz, one estimate for every reading of the sensors."""

from __future__ import annotations

from typing import ClassVar

import numpy as np

from surefoot.bus.messages import ControlMode, HardwareState, LegStatus, MotionReference, StateEstimate
from surefoot.bus.topics import TOPICS
from surefoot.components.component import Component, Inbox, Outbox
from surefoot.components.estimator.contact_aided_filter import ContactAidedFilter
from surefoot.components.estimator.contact_detector import ContactDetector
from surefoot.components.estimator.contact_force import ContactForce
from surefoot.components.estimator.surface_normal import SurfaceNormal
from surefoot.components.footing import is_firm, is_probing
from surefoot.components.memory import Memory
from surefoot.components.robot_model import LegKinematics
from surefoot.components.robot_model.rotation import cross, exp_rotation, quaternion_of, skew
from surefoot.config.deployment import Deployment
from surefoot.config.robot import GRAVITY

_MAX_GAP_S = 0.02
_ROUNDING_S = 1e-9  # of the times of one reading
_REST_TOLERANCE = 1.0  # [m/s^2]


class Estimator(Component):
    """Base and feet from IMU, encoders and torque estimates.

    A foot holds the base only if eq. (7) says that it is in contact and the state machine does not know
    better: on ground that is being probed its covariance is inflated, and while it swings or collapses it
    is not used at all.
    """

    name: ClassVar[str] = "estimator"
    inputs: ClassVar[tuple[str, ...]] = ("hw/state", "fsm/reference")
    outputs: ClassVar[tuple[str, ...]] = ("state/estimate",)
    memory: ClassVar[Memory] = Memory(
        "_force_B",
        "_contact_WF",
        "_last_t",
        _filter=ContactAidedFilter,
        _detector=ContactDetector,
        _normal=SurfaceNormal,
    )

    def __init__(self, deployment: Deployment):
        super().__init__(deployment)
        robot = deployment.load_robot()
        self._settings = deployment.estimator
        self._legs = LegKinematics(robot)
        self._foot_radius = robot.foot.radius
        self._filter = ContactAidedFilter(self._settings)
        self._force = ContactForce(robot, self._settings.friction_speed)
        self._detector = ContactDetector(self._settings)
        self._normal = SurfaceNormal(self._settings)
        dt = 1.0 / TOPICS["hw/state"].rate_hz
        self._dt = dt
        self._force_gain = 1.0 - np.exp(-2.0 * np.pi * self._settings.force_filter_hz * dt)
        self._force_B = np.zeros((4, 3))
        self._contact_WF = np.zeros((4, 3))
        self._last_t: float | None = None

    def activate(self, t: float, inbox: Inbox) -> bool:
        return self._last_t is not None or not self.waiting_for(t, inbox)

    def waiting_for(self, t: float, inbox: Inbox) -> str:
        state = inbox.fresh("hw/state", t)
        if state is None:
            return "no fresh message on hw/state: is io running?"
        g = float(np.sqrt(state.acc_B @ state.acc_B))
        if abs(g - GRAVITY) > _REST_TOLERANCE:
            return f"accelerometer reads {g:.1f} m/s^2, not {GRAVITY}: the robot must rest before tilt can be told"
        return ""

    def step(self, t: float, inbox: Inbox, outbox: Outbox) -> None:
        """An estimate for every message; of a reading that comes again, as on a link that lost one, the same."""
        state = inbox.fresh("hw/state", t)
        if state is None:
            return
        q = state.q.reshape(4, 3)
        p_BF, J_B = self._legs.position(q), self._legs.jacobian(q)
        if self._last_t is None or state.t > self._last_t + _ROUNDING_S:
            force_W, healthy = self._take(state, p_BF, J_B, inbox.fresh("fsm/reference", t))
        else:
            force_W, healthy = self._force_B @ self._filter.R_WB.T, True
        self._publish(state, p_BF, J_B, force_W, healthy, outbox)

    def _take(
        self, state: HardwareState, p_BF: np.ndarray, J_B: np.ndarray, reference: MotionReference | None
    ) -> tuple[np.ndarray, bool]:
        """Take in a reading; filtered forces in the world (4, 3) [N], and whether the filter is sound."""
        q, dq = state.q.reshape(4, 3), state.dq.reshape(4, 3)
        dt = self._dt
        if self._last_t is None:
            self._begin(state, p_BF)
        else:
            dt = min(max(state.t - self._last_t, 1e-4), _MAX_GAP_S)
            self._filter.predict(state.omega_WB_B, state.acc_B, dt)
        self._last_t = state.t
        contact, force_W = self._contacts(state, J_B)
        status = reference.leg_status if reference is not None else np.full(4, LegStatus.STANCE)
        stance = contact & is_firm(status)
        rate = np.where(is_probing(status), self._settings.probing_rate, self._settings.stance_rate)
        self._filter.update(p_BF, J_B, stance, rate, dt, self._rolling(q, dq))
        if (state.damping or _at_rest(reference)) and not stance.any() and self._lies_still(state):
            self._filter.rest()
        healthy = self._guard(state, p_BF)
        self._contact_WF[contact] = self._feet(p_BF)[contact]
        self._normal.update(self._contact_WF)
        return force_W, healthy

    def _begin(self, state: HardwareState, p_BF: np.ndarray) -> None:
        self._filter.start(state.acc_B, p_BF, self._foot_radius)
        self._detector.assume(np.ones(4, bool))
        self._contact_WF = self._filter.p_WB + p_BF @ self._filter.R_WB.T

    def _lies_still(self, state: HardwareState) -> bool:
        """Whether the inertial sensors see no motion; of a robot that no foot holds: it lies, or hangs."""
        off = abs(float(np.sqrt(state.acc_B @ state.acc_B)) - GRAVITY)
        turning = float(np.abs(self._filter.omega_B).max())
        return off < _REST_TOLERANCE and turning < self._settings.rest_rate

    def _rolling(self, q: np.ndarray, dq: np.ndarray) -> np.ndarray:
        """(4, 3) velocity of the foot centres in the world when the feet roll on the ground without slip [m/s].

        The foot is a sphere of radius r, fixed to the calf: its centre moves with omega x r n. A leg that turns
        by 1 rad over its foot rolls it on by r, which is 7 % of the way of the hip above it.
        """
        f = self._filter
        knee = dq[:, 1] + dq[:, 2]
        omega_B = np.empty((4, 3))
        omega_B[:, 0], omega_B[:, 1], omega_B[:, 2] = dq[:, 0], np.cos(q[:, 0]) * knee, np.sin(q[:, 0]) * knee
        omega_B += f.omega_B
        return cross(omega_B @ f.R_WB.T, self._foot_radius * self._normal.normal_W)

    def _contacts(self, state: HardwareState, J_B: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """Contact flags (4,) and filtered forces in the world (4, 3) [N], eq. (7)."""
        f = self._filter
        bias = self._force.bias(f.R_WB, quaternion_of(f.R_WB), f.omega_B, state.q, state.dq)
        force_B = self._force.force(J_B, state.tau, bias)
        self._force_B = self._force_B + self._force_gain * (force_B - self._force_B)
        force_W = self._force_B @ f.R_WB.T
        return self._detector.update(force_W @ self._normal.normal_W), force_W

    def _guard(self, state: HardwareState, p_BF: np.ndarray) -> bool:
        """False, after starting again at the last position and heading, when the filter has diverged.

        One invalid estimate is enough: the state machine damps the robot and waits for a command.
        """
        f, limit = self._filter, self._settings.position_limit
        uncertain = f.P[[2, 6, 7], [2, 6, 7]]
        if np.isfinite(f.p_WB).all() and np.isfinite(uncertain).all() and (uncertain < limit * limit).all():
            return True
        position = np.where(np.isfinite(f.p_WB), f.p_WB, 0.0)
        yaw = float(np.nan_to_num(np.arctan2(f.R_WB[1, 0], f.R_WB[0, 0])))
        f.start(state.acc_B, p_BF, self._foot_radius)
        f.p_WB[:] = position
        f.R_WB = exp_rotation(np.array([0.0, 0.0, yaw])) @ f.R_WB
        return False

    def _feet(self, p_BF: np.ndarray) -> np.ndarray:
        """(4, 3) foot centres in the world [m]."""
        return self._filter.p_WB + p_BF @ self._filter.R_WB.T

    def _publish(
        self,
        state: HardwareState,
        p_BF: np.ndarray,
        J_B: np.ndarray,
        force_W: np.ndarray,
        healthy: bool,
        outbox: Outbox,
    ) -> None:
        f = self._filter
        rotating_B = p_BF @ skew(f.omega_B).T
        v_WF = f.v_WB_W + (rotating_B + (J_B @ state.dq.reshape(4, 3, 1))[..., 0]) @ f.R_WB.T
        outbox.publish(
            "state/estimate",
            StateEstimate(
                t=state.t,
                valid=healthy,
                p_WB=f.p_WB.copy(),
                quat_WB=quaternion_of(f.R_WB),
                v_WB_W=f.v_WB_W.copy(),
                omega_WB_B=f.omega_B,
                q=state.q,
                dq=state.dq,
                p_WF=self._feet(p_BF),
                v_WF=v_WF,
                force_W=force_W,
                contact=self._detector.contact,
                normal_W=self._normal.normal_W,
                covariance=f.P[:9, :9].copy(),
                foot_std_m=np.sqrt(np.maximum(np.diagonal(f.P)[9:21], 0.0)).reshape(4, 3),
            ),
        )


def _at_rest(reference: MotionReference | None) -> bool:
    """Whether the joints are damped, or held where they are: nothing drives the robot that no foot holds."""
    if reference is None:
        return False
    held = reference.mode == ControlMode.JOINT and np.array_equal(reference.joint_from, reference.joint_to)
    return reference.mode == ControlMode.DAMP or held
