"""Whether the base is where it must be over the feet that carry, before a lift-off and until the foot is back."""

from __future__ import annotations

import numpy as np

from surefoot.bus.messages import MotionReference
from surefoot.components.fsm.observation import Observation
from surefoot.components.fsm.support_triangle import SupportTriangle
from surefoot.components.memory import Memory
from surefoot.config.fsm import Fsm

_ROUNDING_S = 1e-9


class Lasting:
    """Tells when something has been true for long enough without a break."""

    memory = Memory("_since")

    def __init__(self, seconds: float):
        self._seconds = seconds
        self._since: float | None = None

    def restart(self) -> None:
        """Forget what was true."""
        self._since = None

    def update(self, t: float, true: bool) -> bool:
        """Take in what holds at time t [s]."""
        if not true:
            self._since = None
        elif self._since is None:
            self._since = t
        return self._since is not None and t - self._since >= self._seconds - _ROUNDING_S


class Balance:
    """Judges the centre of mass against the triangle of the feet other than the one that is moved."""

    memory = Memory(_at_rest=Lasting, _lost=Lasting)

    def __init__(self, settings: Fsm):
        self._settings = settings
        self._at_rest = Lasting(settings.shift_hold_s)
        self._lost = Lasting(settings.unsteady_s)

    def begin_shift(self) -> None:
        """The base sets off: whatever rest there was is over."""
        self._at_rest.restart()

    def inside(self, now: Observation, reference: MotionReference, leg: int) -> bool:
        """The other three feet can carry the robot, at rest or not."""
        return SupportTriangle(reference.p_WF, leg).margin(now.com_W[:2]) >= self._settings.margin_m

    def ready(self, now: Observation, reference: MotionReference, leg: int) -> bool:
        """The base has come to rest inside the triangle: the leg may lift off."""
        settings = self._settings
        margin = SupportTriangle(reference.p_WF, leg).margin(now.com_W[:2])
        speed = float(np.hypot(*now.estimate.v_WB_W[:2]))
        inside = margin >= settings.shift_margin_m and speed < settings.shift_rest_speed
        return self._at_rest.update(now.t, inside)

    def lost(self, now: Observation, reference: MotionReference, leg: int) -> str:
        """Why the step must be given up, or "": the trunk tilts, or the CoM nears the edge of the triangle."""
        why = self._unsteady(now, reference, leg)
        return why if self._lost.update(now.t, bool(why)) else ""

    def _unsteady(self, now: Observation, reference: MotionReference, leg: int) -> str:
        settings = self._settings
        tilt = float(np.arccos(np.clip(now.up_W @ reference.normal_W, -1.0, 1.0)))
        if tilt > settings.tilt_hold:
            return f"base tilted by {tilt:.2f} rad from the ground, limit {settings.tilt_hold} rad"
        margin = SupportTriangle(reference.p_WF, leg).margin(now.com_W[:2])
        if settings.support_polygon and margin < settings.margin_hold_m:
            return f"centre of mass {1e3 * margin:.0f} mm inside, limit {1e3 * settings.margin_hold_m:.0f} mm"
        return ""
