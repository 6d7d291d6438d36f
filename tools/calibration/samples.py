"""Readings of a stretch of time, as arrays."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from scipy.signal import savgol_filter

from surefoot.bus.messages import HardwareState
from surefoot.hw.robot_interface import Sensors


@dataclass(frozen=True)
class Samples:
    """n readings in order of time; joints and feet FL, FR, RL, RR."""

    t: np.ndarray  # (n,) [s]
    q: np.ndarray  # (n, 12) [rad]
    dq: np.ndarray  # (n, 12) [rad/s]
    tau: np.ndarray  # (n, 12) torque estimates [N m]
    omega_WB_B: np.ndarray  # (n, 3) [rad/s]
    acc_B: np.ndarray  # (n, 3) specific force [m/s^2]
    foot_force: np.ndarray | None  # (n, 4) raw; None from a robot without foot sensors
    temperature: float | None  # of the motors, mean [deg C]; None where nobody tells

    @property
    def seconds(self) -> float:
        """From the first to the last [s]."""
        return float(self.t[-1] - self.t[0])

    @property
    def rate(self) -> np.ndarray:
        """(12,) mean velocity of each joint by its angles, of the first third and the last [rad/s]."""
        third = len(self.t) // 3
        way = self.q[-third:].mean(axis=0) - self.q[:third].mean(axis=0)
        return way / (self.t[-third:].mean() - self.t[:third].mean())

    def acceleration(self, window_s: float) -> np.ndarray:
        """(n, 12) slope of a parabola through the velocities of `window_s` around a sample, without lag [rad/s^2].

        What was asked of a joint would not do: it follows late, and M (ddq - ddq_asked) looks like damping.
        """
        dt = self.seconds / (len(self.t) - 1)
        return savgol_filter(self.dq, 2 * round(0.5 * window_s / dt) + 1, 2, deriv=1, delta=dt, axis=0)

    @property
    def up_B(self) -> np.ndarray:
        """(3,) unit vector against gravity in the trunk, as the accelerometer tells."""
        mean = self.acc_B.mean(axis=0)
        return mean / np.linalg.norm(mean)


def samples_of(t: Sequence[float], readings: Sequence[Sensors] | Sequence[HardwareState]) -> Samples:
    """Readings at the times `t` [s], at least three; what repeats an earlier one counts once."""
    new = np.flatnonzero(np.diff(t, prepend=-np.inf) > 0.0).tolist()

    def stacked(name: str) -> np.ndarray:
        return np.array([getattr(readings[index], name) for index in new], float)

    heat = getattr(readings[-1], "temperature", None)  # which is not on the bus
    has_feet = readings[0].foot_force is not None and len(readings[0].foot_force) == 4
    return Samples(
        t=np.array(t, float)[new],
        q=stacked("q"),
        dq=stacked("dq"),
        tau=stacked("tau"),
        omega_WB_B=stacked("omega_WB_B"),
        acc_B=stacked("acc_B"),
        foot_force=stacked("foot_force") if has_feet else None,
        temperature=None if heat is None else float(np.mean(heat)),
    )
