"""States outside Fig. 6, in which the joints are damped or moved between two postures."""

from __future__ import annotations

from dataclasses import dataclass
from enum import StrEnum

import numpy as np

from surefoot.bus.messages import ControlMode, MotionReference
from surefoot.config.robot import JOINT_NAMES


class Posture(StrEnum):
    """What the robot is at when it does not walk."""

    DAMP = "DAMP"
    HOLD = "HOLD"
    STAND_UP = "STAND_UP"
    STAND = "STAND"
    SIT_DOWN = "SIT_DOWN"


@dataclass(frozen=True)
class JointMove:
    """A motion of every joint from one posture to another, at rest at both ends.

    Attributes:
        q_from: where it begins [rad], shape (12,).
        q_to: where it ends [rad], shape (12,).
        t0: when it begins [s].
        t1: when it ends [s].
    """

    q_from: np.ndarray
    q_to: np.ndarray
    t0: float = 0.0
    t1: float = 0.0

    def farthest(self, q: np.ndarray) -> tuple[str, float]:
        """The joint of angles `q` (12,) that is farthest from where the motion ends, and how far it is [rad]."""
        error = np.abs(q - self.q_to)
        worst = int(np.argmax(error))
        return JOINT_NAMES[worst], float(error[worst])


def posture_reference(t: float, posture: Posture, reason: str, move: JointMove) -> MotionReference:
    """The reference at time `t` [s] of a robot that does not balance; its joints make `move`."""
    return MotionReference(
        t=t,
        valid=True,
        state=str(posture),
        reason=reason,
        mode=ControlMode.DAMP if posture is Posture.DAMP else ControlMode.JOINT,
        normal_W=np.array([0.0, 0.0, 1.0]),
        joint_from=move.q_from,
        joint_to=move.q_to,
        joint_t0=move.t0,
        joint_t1=move.t1,
    )
