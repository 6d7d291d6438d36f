"""What truly became of the emulated robot, whatever the stack believes."""

from __future__ import annotations

from math import acos

import numpy as np

from surefoot.bus.messages import SimTruth
from surefoot.hw.robot_interface import MotorLaw

_STANDS_M = 0.30
"""A trunk that is higher has been lifted; it stands at 0.4 m and lies at 0.1 m."""

_FALL_TILT = 0.785  # 45 degrees [rad]
_BODY = ("trunk", "hip", "thigh")  # what touches the ground of a robot that fell; calves brush along edges


class Witness:
    """Sees every cycle of the robot.

    Attributes:
        forward_m: of the trunk, since the first cycle.
        height_m: of the trunk now.
        stood_t: when it first stood, on the robot's clock [s]; None before.
        tilt: the largest of the trunk from the vertical, since then [rad].
        fell: in words how it fell, since then; empty while it has not. A robot that is damped sinks to the ground:
            that is no fall unless it topples. One that is driven to lie down cannot be told from one that falls.
        crossed: all four feet have been past the end of the terrain at once.
        damped_t: since when no motor has been driven [s]; None while one is.
    """

    def __init__(self, end_x: float):
        """`end_x`: where the terrain ends [m]."""
        self._end_x = end_x
        self.crossed = False
        self.damped_t: float | None = 0.0
        self.forward_m = self.height_m = self.tilt = 0.0
        self.stood_t: float | None = None
        self.fell = ""
        self._up = False
        self._begin: float | None = None

    def see(self, truth: SimTruth, law: MotorLaw, t: float) -> None:
        """The truth at time `t` of the robot's clock [s], and the law that the motors have followed till then."""
        if law.kp.any() or law.tau.any() or law.dq.any():
            self.damped_t = None
        elif self.damped_t is None:
            self.damped_t = t
        x, _, self.height_m = truth.p_WB.tolist()
        self._begin = x if self._begin is None else self._begin
        self.forward_m = x - self._begin
        if self.height_m > _STANDS_M and not truth.body_contact:
            self._up, self.stood_t = True, t if self.stood_t is None else self.stood_t
        if self.stood_t is None or self.fell:
            return
        self.crossed = self.crossed or bool((truth.p_WF[:, 0] > self._end_x).all())
        self.tilt = max(self.tilt, tilt_of(truth.quat_WB))
        if self.tilt > _FALL_TILT:
            self.fell = f"tilted by {self.tilt:.2f} rad at {t:.3f} s"
        elif self._up and any(part in truth.body_contact for part in _BODY):
            self._up = False
            if self.damped_t is None:
                self.fell = f"touched the ground with {truth.body_contact} at {t:.3f} s"

    def __str__(self) -> str:
        if self.stood_t is None:
            return "the robot has not stood"
        end = self.fell or f"upright, tilted by {self.tilt:.2f} rad at the most"
        far = " to the far side" if self.crossed else ""
        return f"the robot stood at {self.stood_t:.1f} s and went {self.forward_m:.2f} m forward{far}: {end}"


def tilt_of(quat_WB: np.ndarray) -> float:
    """Of a trunk (w, x, y, z) from the vertical [rad]."""
    _, x, y, _ = quat_WB.tolist()
    return acos(min(max(1.0 - 2.0 * (x * x + y * y), -1.0), 1.0))
