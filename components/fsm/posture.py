"""States outside Fig. 6, in which the joints are damped or moved between two postures."""

from __future__ import annotations

from enum import StrEnum
from typing import Any

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


def farthest_joint(q: np.ndarray, posture_q: np.ndarray) -> tuple[str, float]:
    """The joint of angles `q` (12,) farthest from a posture (12,), and how far it is [rad]."""
    error = np.abs(q - posture_q)
    worst = int(np.argmax(error))
    return JOINT_NAMES[worst], float(error[worst])


def posture_reference(t: float, posture: Posture, reason: str, **joints: Any) -> MotionReference:
    """The reference at time `t` [s] of a robot that does not balance; `joints` are its `joint_...` fields."""
    return MotionReference(
        t=t,
        valid=True,
        state=str(posture),
        reason=reason,
        mode=ControlMode.DAMP if posture is Posture.DAMP else ControlMode.JOINT,
        normal_W=np.array([0.0, 0.0, 1.0]),
        **joints,
    )
