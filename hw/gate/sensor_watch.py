"""Whether measurements can be used, and what they say of single joints."""

from __future__ import annotations

import numpy as np

from surefoot.config.gate import Gate as Settings
from surefoot.config.robot import JOINT_NAMES
from surefoot.hw.gate.check import Check, Violation
from surefoot.hw.gate.limits import Limits
from surefoot.hw.robot_interface import Sensors

_ABSURD = 1e6  # of any figure in its unit: no sensor measures it, and products with it stay finite
_FIELDS = ("q", "dq", "tau", "omega_WB_B", "acc_B")


class SensorWatch:
    """Looks at one reading at a time; remembers none."""

    def __init__(self, limits: Limits, settings: Settings):
        self._speed, self._settings = limits.measured_speed, settings

    def unusable(self, sensors: Sensors, age_s: float) -> Violation | None:
        """Why nothing can be told from a reading that is `age_s` old [s]."""
        figures = [getattr(sensors, name) for name in _FIELDS]
        if sensors.temperature is not None:
            figures.append(sensors.temperature)
        if not (np.abs(np.concatenate(figures)) < _ABSURD).all():
            for name, values in zip((*_FIELDS, "temperature"), figures, strict=False):
                usable = np.abs(values) < _ABSURD
                if not usable.all():
                    at = int(np.argmin(usable))
                    where = JOINT_NAMES[at] if len(values) == len(JOINT_NAMES) else "xyz"[at]
                    return Violation(Check.NO_MEASUREMENT, f"measured {name} of {where} = {values[at]:.3g}")
        limit = self._settings.state_timeout_s
        if not abs(age_s) <= limit:  # one that is ahead of time is dated by another clock
            return Violation(Check.STALE, f"measurements are {1e3 * age_s:.1f} ms old, limit {1e3 * limit:.0f} ms")
        return None

    def heat(self, sensors: Sensors) -> Violation | None:
        """A motor that is warm or hot; none where nobody measures it."""
        if sensors.temperature is None:
            return None
        joint = int(np.argmax(sensors.temperature))
        degrees, settings = float(sensors.temperature[joint]), self._settings
        for check, limit in ((Check.HOT, settings.temperature_max), (Check.WARM, settings.temperature_warn)):
            if degrees > limit:
                return Violation(
                    check, f"motor of {JOINT_NAMES[joint]} has {degrees:.0f} deg C, limit {limit:.0f}"
                )
        return None

    def speed(self, sensors: Sensors) -> Violation | None:
        """A joint that is too fast."""
        over = np.abs(sensors.dq) - self._speed
        joint = int(np.argmax(over))
        if over[joint] <= 0.0:
            return None
        found, limit = sensors.dq[joint], self._speed[joint]
        return Violation(
            Check.SPEED, f"measured dq of {JOINT_NAMES[joint]} = {found:.2f} rad/s, limit {limit:.2f}"
        )
