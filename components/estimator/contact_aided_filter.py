"""Error-state Kalman filter of base and feet: inertial prediction, leg kinematics as measurement.

State: p_WB, v_WB_W, R_WB, the four foot positions p_WF, gyroscope and accelerometer biases. Error (27):
position 0:3, velocity 3:6, rotation in the world 6:9 (R = exp(theta) R_estimated), feet 9:21, gyroscope
bias 21:24, accelerometer bias 24:27. A foot in stance is a point that stays; what the encoders say of its
place in the base then holds the base. Method: Bloesch et al., "State estimation for legged robots:
consistent fusion of leg kinematics and IMU", RSS 2012.
"""

from __future__ import annotations

import numpy as np

from surefoot.components.memory import Memory
from surefoot.components.robot_model.rotation import exp_rotation, skew
from surefoot.config.estimator import Estimator
from surefoot.config.robot import GRAVITY

SIZE = 27
_P, _V, _TH, _BG, _BA = slice(0, 3), slice(3, 6), slice(6, 9), slice(21, 24), slice(24, 27)
_FEET = 9
_UNKNOWN_M = 1.0
_EYE3 = np.eye(3)
_LEGS = np.arange(4)


class ContactAidedFilter:
    """The filter; all arrays are its own and updated in place.

    Attributes:
        p_WB, v_WB_W: (3,) position [m] and velocity [m/s].
        R_WB: (3, 3).
        p_WF: (4, 3) foot position states [m].
        bias_gyro, bias_acc: (3,).
        P: (27, 27) error covariance.
        omega_B: (3,) angular velocity without bias [rad/s].
        known: (4,) feet whose position is a state of its own, not the base's.
    """

    memory = Memory("p_WB", "v_WB_W", "R_WB", "p_WF", "bias_gyro", "bias_acc", "omega_B", "P", "known")

    def __init__(self, settings: Estimator):
        self._settings = settings
        self.p_WB, self.v_WB_W = np.zeros(3), np.zeros(3)
        self.R_WB = np.eye(3)
        self.p_WF = np.zeros((4, 3))
        self.bias_gyro, self.bias_acc = np.zeros(3), np.zeros(3)
        self.omega_B = np.zeros(3)
        self.P = np.zeros((SIZE, SIZE))
        self._H = np.zeros((12, SIZE))
        self._H[:, _P] = -np.tile(_EYE3, (4, 1))
        self._H[:, _FEET : _FEET + 12] = np.eye(12)
        self.known = np.zeros(4, bool)
        self._F = np.eye(SIZE)
        self._gravity_W = np.array([0.0, 0.0, -GRAVITY])

    @property
    def _diagonal(self) -> np.ndarray:
        """(27,) the variances, a view."""
        return self.P.reshape(-1)[:: SIZE + 1]

    def start(self, acc_B: np.ndarray, p_BF: np.ndarray, foot_height_m: float) -> None:
        """Begin at rest: tilt from gravity, yaw zero, feet on average at `foot_height_m`.

        Args:
            acc_B: (3,) one accelerometer reading [m/s^2].
            p_BF: (4, 3) foot centres in the base [m].
            foot_height_m: height of foot centres on the ground [m].
        """
        settings = self._settings
        up_B = acc_B / np.sqrt(acc_B @ acc_B)
        pitch = np.arcsin(np.clip(-up_B[0], -1.0, 1.0))
        roll = np.arctan2(up_B[1], up_B[2])
        self.R_WB = exp_rotation(np.array([0.0, pitch, 0.0])) @ exp_rotation(np.array([roll, 0.0, 0.0]))
        height = foot_height_m - (p_BF @ self.R_WB.T)[:, 2].mean()
        self.p_WB = np.array([settings.start_x_m, settings.start_y_m, height])
        self.v_WB_W[:] = 0.0
        self.bias_gyro[:], self.bias_acc[:] = 0.0, 0.0
        std = np.full(SIZE, 1e-3)
        std[_V] = 0.02
        std[_TH] = [settings.tilt_start, settings.tilt_start, 1e-4]
        std[_BG], std[_BA] = settings.gyro_bias_start, settings.acc_bias_start
        self.P[:] = np.diag(std**2)
        self.known[:] = False

    def predict(self, gyro_B: np.ndarray, acc_B: np.ndarray, dt: float) -> None:
        """Integrate one IMU sample over `dt` [s]."""
        settings, R = self._settings, self.R_WB
        self.omega_B = gyro_B - self.bias_gyro
        specific_W = R @ (acc_B - self.bias_acc)
        acc_W = specific_W + self._gravity_W
        self.p_WB += dt * self.v_WB_W + (0.5 * dt * dt) * acc_W
        self.v_WB_W += dt * acc_W
        self.R_WB = R @ exp_rotation(self.omega_B * dt)
        F = self._F
        F[_P, _V] = dt * _EYE3
        F[_V, _TH] = -dt * skew(specific_W)
        F[_V, _BA] = -dt * R
        F[_TH, _BG] = -dt * R
        self.P[:] = F @ self.P @ F.T
        diagonal = self._diagonal
        diagonal[_V] += (settings.acc * dt) ** 2
        diagonal[_TH] += (settings.gyro * dt) ** 2
        diagonal[_BG] += settings.gyro_bias_rate**2 * dt
        diagonal[_BA] += settings.acc_bias_rate**2 * dt

    def update(
        self,
        p_BF: np.ndarray,
        J_B: np.ndarray,
        stance: np.ndarray,
        foot_rate: np.ndarray,
        dt: float,
        rolling_W: np.ndarray | float = 0.0,
    ) -> np.ndarray:
        """Correct with the leg kinematics of stance feet; feet in the air follow the base.

        Args:
            p_BF: (4, 3) foot centres in the base from the encoders [m].
            J_B: (4, 3, 3) foot Jacobians in the base [m/rad].
            stance: (4,) feet that may hold the base.
            foot_rate: (4,) random walk of each stance foot [m/sqrt(s)].
            dt: time since the last update [s].
            rolling_W: (4, 3) velocity of each foot centre that rolls on its contact point [m/s].

        Returns:
            (4,) the feet that were used: in stance and not slipping.

        The residual of a foot is R y - (f - p) = df - dp + [R y]x dtheta + noise.
        """
        arm_W = p_BF @ self.R_WB.T
        self.p_WF += dt * rolling_W
        self._place_feet(arm_W, stance)
        self._diagonal[_FEET : _FEET + 12] += np.repeat(stance * foot_rate**2 * dt, 3)
        residual = arm_W - (self.p_WF - self.p_WB)
        J_W = self.R_WB @ J_B
        noise = self._settings.encoder**2 * (J_W @ J_W.transpose(0, 2, 1)) + self._settings.kinematics**2 * _EYE3
        H = self._H
        H.reshape(4, 3, SIZE)[:, :, _TH] = skew(arm_W)
        PHt = self.P @ H.T
        S = H @ PHt
        blocks = S.reshape(4, 3, 4, 3)[_LEGS, :, _LEGS]
        blocks += noise
        S.reshape(4, 3, 4, 3)[_LEGS, :, _LEGS] = blocks
        distance = (residual[:, None] @ np.linalg.inv(blocks) @ residual[:, :, None])[:, 0, 0]
        used = stance & (distance < self._settings.slip_gate)
        if used.any():
            rows = np.flatnonzero(np.repeat(used, 3))
            PHt = PHt[:, rows]
            K = PHt @ np.linalg.inv(S[rows[:, None], rows])
            self.P -= K @ PHt.T
            self.P += self.P.T.copy()
            self.P *= 0.5
            self._inject(K @ residual.ravel()[rows])
        for leg in np.flatnonzero(stance & ~used).tolist():
            self.known[leg] = False
            self._forget(leg, self.R_WB @ p_BF[leg])
        return used

    def rest(self) -> None:
        """Correct with a base that lies still: on its belly nothing else holds it.

        What the inertial sensors drift by would be taken for tilt and bias as soon as a foot holds again.
        """
        PHt = self.P[:, _V]
        K = PHt @ np.linalg.inv(self.P[_V, _V] + self._settings.rest_speed**2 * _EYE3)
        self.P -= K @ PHt.T
        self.P[:] = 0.5 * (self.P + self.P.T)
        self._inject(-K @ self.v_WB_W)

    def _inject(self, error: np.ndarray) -> None:
        self.p_WB += error[_P]
        self.v_WB_W += error[_V]
        self.R_WB = exp_rotation(error[_TH]) @ self.R_WB
        self.p_WF += error[_FEET : _FEET + 12].reshape(4, 3)
        self.bias_gyro += error[_BG]
        self.bias_acc += error[_BA]

    def _place_feet(self, arm_W: np.ndarray, stance: np.ndarray) -> None:
        for leg in range(4):
            if not stance[leg]:
                self.known[leg] = False
                self._forget(leg, arm_W[leg])
            elif not self.known[leg]:
                self.known[leg] = True
                self._begin_stance(leg, arm_W[leg])

    def _forget(self, leg: int, arm_W: np.ndarray) -> None:
        """A foot in the air: where the base says, tied to nothing."""
        foot = slice(_FEET + 3 * leg, _FEET + 3 * leg + 3)
        self.p_WF[leg] = self.p_WB + arm_W
        self.P[foot, :] = 0.0
        self.P[:, foot] = 0.0
        self.P[foot, foot] = _UNKNOWN_M**2 * _EYE3

    def _begin_stance(self, leg: int, arm_W: np.ndarray) -> None:
        """A new foothold: df = dp - [R y]x dtheta + encoder noise, with its correlations."""
        foot = slice(_FEET + 3 * leg, _FEET + 3 * leg + 3)
        self.p_WF[leg] = self.p_WB + arm_W
        self.P[foot, :] = 0.0
        self.P[:, foot] = 0.0
        rows = self.P[_P, :] - skew(arm_W) @ self.P[_TH, :]
        self.P[foot, :] = rows
        self.P[:, foot] = rows.T
        corner = rows[:, _P] - rows[:, _TH] @ skew(arm_W).T
        self.P[foot, foot] = corner + self._settings.kinematics**2 * _EYE3
