"""The motion reference, and the verbs by which stepping and probing change it."""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np

from surefoot.bus.messages import ControlMode, LegStatus, MotionReference
from surefoot.components.footing import is_firm, is_sinking, is_trusted
from surefoot.components.fsm.observation import Observation
from surefoot.components.memory import Memory
from surefoot.config.fsm import Fsm

LIFT_AHEAD_S = 0.10
"""A lift-off stays this far ahead until the base is ready: the MPC unloads the foot in time."""

LAND_AHEAD_S = 0.03
"""While contact is awaited, touch-down stays this far ahead."""

_UP = np.array([0.0, 0.0, 1.0])
_NONE = -1
_ALWAYS = 1e9  # end of a constraint that lasts until it is taken away [s]


@dataclass(frozen=True)
class Region:
    """Eq. (4): A p + b >= 0 for the place p (3,) where a foot touches down [m].

    Attributes:
        a: (4, 3) rows A.
        b: (4,) [m].
    """

    a: np.ndarray
    b: np.ndarray


class Motion:
    """What the robot is asked to do now.

    Attributes:
        reference: the message for the MPC, the whole-body controller and the estimator.
    """

    memory = Memory("_ground", reference=MotionReference)

    def __init__(self, settings: Fsm):
        self._settings = settings
        self._ground = np.full(4, LegStatus.STANCE)  # what each leg stands on, or stood on before it was lifted
        self.reference = MotionReference(mode=ControlMode.BALANCE, normal_W=_UP)

    @property
    def trusted(self) -> np.ndarray:
        """(4,) feet that stand on trusted ground."""
        return is_trusted(self.reference.leg_status)

    @property
    def grounded(self) -> np.ndarray:
        """(4,) legs that stand on trusted ground, or stood on it before they were lifted."""
        return is_trusted(self._ground)

    @property
    def sinking(self) -> np.ndarray:
        """(4,) feet on ground that gives way."""
        return is_sinking(self.reference.leg_status)

    @property
    def bearing(self) -> np.ndarray:
        """(4,) feet that stand on ground not known to give way."""
        return is_firm(self.reference.leg_status)

    @property
    def in_air(self) -> bool:
        """A leg swings, or looks for the ground."""
        status = self.reference.leg_status.tolist()
        return LegStatus.SWING in status or LegStatus.LANDING in status

    def trust(self, leg: int) -> None:
        """The ground under a foot has borne its load."""
        self._ground[leg] = LegStatus.STANCE

    def distrust(self, leg: int, now: Observation) -> None:
        """The ground under a foot gives way: until it is lifted nobody may hold on to it, nor draw it back."""
        self._ground[leg] = LegStatus.COLLAPSING
        status, feet = self.reference.leg_status.copy(), self.reference.p_WF.copy()
        status[leg], feet[leg] = LegStatus.COLLAPSING, now.estimate.p_WF[leg]
        self.reference = replace(self.reference, leg_status=status, p_WF=feet)

    def stand(self, now: Observation, pose: np.ndarray, seconds: float) -> None:
        """Four feet where they are, on what they are known to stand on; the base to a pose (6,)."""
        self.reference = MotionReference(
            mode=ControlMode.BALANCE,
            normal_W=now.estimate.normal_W,
            p_WF=now.estimate.p_WF,
            leg_status=self._ground.copy(),
            base_from=now.pose,
            base_to=pose,
            base_t0=now.t,
            base_t1=now.t + seconds,
        )

    def lean_off(self, leg: int, now: Observation, pose: np.ndarray, seconds: float) -> None:
        """Four feet where they are, the base to a pose (6,) inside the feet other than `leg`, by eq. (5)."""
        self.stand(now, pose, seconds)
        self.reference = replace(self.reference, **self._support(leg, now.t, now.t))

    def plant(self, now: Observation) -> None:
        """All feet stand where they are; no constraint of probing acts."""
        self.reference = replace(
            self.reference,
            p_WF=now.estimate.p_WF.copy(),
            leg_status=self._ground.copy(),
            swing_leg=_NONE,
            support_leg=_NONE,
            probe_leg=_NONE,
            **_within(None),
        )

    def on_plane(self, now: Observation) -> None:
        """Take over where the feet stand and the local normal; a leg in the air stays there."""
        feet = now.estimate.p_WF.copy()
        self.reference = replace(self.reference, p_WF=feet, normal_W=now.estimate.normal_W)

    def time_to(self, pose: np.ndarray, now: Observation) -> float:
        """How long the base takes to a pose (6,) at the mean speed of a shift [s]."""
        return float(np.linalg.norm(pose[:3] - now.estimate.p_WB)) / self._settings.shift_speed

    def shift_base(self, now: Observation, pose: np.ndarray, duration: float) -> None:
        """The base moves to a pose (6,) in a straight line."""
        self.reference = replace(
            self.reference, base_from=now.pose, base_to=pose, base_t0=now.t, base_t1=now.t + duration
        )

    def plan_swing(
        self,
        leg: int,
        start: float,
        to: np.ndarray,
        now: Observation,
        duration: float,
        height: float,
        region: Region | None = None,
    ) -> None:
        """A leg is to lift off at a time and land at a point (3,), inside a region where there is one."""
        settings = self._settings
        self.reference = replace(
            self.reference,
            swing_leg=leg,
            swing_t0=start,
            swing_t1=start + duration,
            swing_from=now.estimate.p_WF[leg].copy(),
            swing_to=to,
            swing_height=height,
            swing_v_lift=settings.swing_v_lift,
            swing_v_touch=settings.swing_v_touch,
            swing_lands=True,
            **_within(region),
            **self._support(leg, start, now.t),
        )

    def postpone(self, now: Observation, duration: float) -> None:
        """The base is not ready: a lift-off that comes too near moves on."""
        start = now.t + LIFT_AHEAD_S
        if self.reference.swing_t0 >= start:
            return
        leg = self.reference.swing_leg
        self.reference = replace(
            self.reference, swing_t0=start, swing_t1=start + duration, **self._support(leg, start, now.t)
        )

    def lift_off(self, now: Observation, duration: float) -> None:
        """The leg whose swing is planned leaves the ground now."""
        leg = self.reference.swing_leg
        feet = now.estimate.p_WF.copy()
        feet[leg] = self.reference.swing_to
        status = self._ground.copy()
        status[leg] = LegStatus.SWING
        self.reference = replace(
            self.reference,
            p_WF=feet,
            leg_status=status,
            probe_leg=_NONE,
            swing_from=now.estimate.p_WF[leg].copy(),
            swing_t0=now.t,
            swing_t1=now.t + duration,
            **self._support(leg, now.t, now.t),
        )

    def descend(self, now: Observation) -> None:
        """Contact is late: the foot goes on down."""
        reference = self.reference
        landing = now.t + LAND_AHEAD_S
        lower = self._settings.swing_v_touch * (landing - reference.swing_t1)
        status = reference.leg_status.copy()
        status[reference.swing_leg] = LegStatus.LANDING
        self.reference = replace(
            reference,
            swing_t1=landing,
            swing_to=reference.swing_to - lower * reference.normal_W,
            leg_status=status,
        )

    def touch_down(self, now: Observation, ground: LegStatus) -> None:
        """The swinging foot stands where it is, on ground of this kind."""
        self._ground[self.reference.swing_leg] = ground
        feet, status = now.estimate.p_WF.copy(), self._ground.copy()
        self.reference = replace(self.reference, p_WF=feet, leg_status=status, swing_leg=_NONE, **_within(None))

    def press(self, leg: int, start: float, forces_W: np.ndarray) -> None:
        """Eq. (6): forces (n, 3) for their dwell each, after the first, which is the one that acts now."""
        settings = self._settings
        self.reference = replace(
            self.reference,
            probe_leg=leg,
            probe_t0=start,
            probe_dwell_s=settings.dwell_s,
            probe_blend_s=settings.blend_s,
            probe_force_W=forces_W,
        )

    def ease(self, leg: int, now: Observation, force_n: float) -> None:
        """The foot that presses is brought down to a normal force, and stays."""
        normal = self.reference.normal_W
        self.reference = replace(self.reference, swing_leg=_NONE)
        self.press(leg, now.t, np.array([now.normal_force(leg) * normal, force_n * normal]))

    def raise_leg(self, leg: int, now: Observation, to: np.ndarray) -> None:
        """LEG_UP: the foot leaves the ground at once and stays in the air at a point (3,)."""
        status = self._ground.copy()
        status[leg] = LegStatus.SWING
        self.reference = replace(
            self.reference,
            leg_status=status,
            probe_leg=_NONE,
            swing_leg=leg,
            swing_t0=now.t,
            swing_t1=now.t + self._settings.leg_up_s,
            swing_from=now.estimate.p_WF[leg].copy(),
            swing_to=to,
            # The foot is falling with the ground: to stop it in one tick would throw the base over.
            swing_v_from=now.estimate.v_WF[leg].copy(),
            swing_lands=False,
            **_within(None),
            **self._support(leg, now.t, now.t),
        )

    def _support(self, leg: int, start: float, t: float) -> dict:
        """Eq. (5) from lift-off on, until the leg's probing is complete; once it acts at time t it stays."""
        on = self._settings.support_polygon and self._settings.probing
        reference = self.reference
        acts = reference.support_leg == leg and reference.support_t0 <= t
        return {
            "support_leg": leg if on else _NONE,
            "support_t0": min(start, reference.support_t0) if acts else start,
            "support_t1": _ALWAYS,
            "support_margin_m": self._settings.margin_m,
        }


def _within(region: Region | None) -> dict:
    """Eq. (4) of a swing to a foothold of the map; hops, ways back and LEG_UP have the whole plane."""
    if region is None:
        return {"region_a": np.zeros((4, 3)), "region_b": np.zeros(4), "region_active": False}
    return {"region_a": region.a, "region_b": region.b, "region_active": True}
