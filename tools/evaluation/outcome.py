"""How a run ends: what is success on each terrain, and what is a failure on all of them."""

from __future__ import annotations

from collections.abc import Callable, Sequence

import numpy as np

from surefoot.bus.messages import MotionReference, SimTruth
from surefoot.hw.mujoco.terrain import Field

FALL_TILT = np.deg2rad(45.0)
STUCK_S = 5.0  # without contact change or support below the surface
BELOW_M = 0.06  # a foot whose centre is this far below the surface is in a hole
CARRIES_N = 10.0  # a foot that bears this much stands
_STOPPED_S = 3.0  # a machine that rests this long waits for a new direction

GivesWay = Callable[[np.ndarray, float], bool]
"""Whether the ground at a point (2,) of the world collapses under a normal force [N]."""


class Outcome:
    """Success or failure of one run.

    Where there is nothing to cross success is the goal; where there is a trap it is to come to rest, four feet on
    ground that bears them, short of the end; elsewhere it is four feet past the terrain's end.

    Attributes:
        failure: why the run has failed, or "".
        passed: all four feet stand past the terrain's end.
        touching: names of the parts that made the run a failure by touching something.
        reason: what the state machine said when the run ended at rest.
    """

    def __init__(self, row: Sequence[str], field: Field, foot_radius: float, gives_way: GivesWay):
        """For kinds of terrain in a row, none for flat ground, that lie in `field`."""
        self._crosses, self._stops = bool(row), "trap" in row
        self._field = field
        self._end_x = field.end_x + foot_radius
        self._gives_way = gives_way
        self.failure, self.touching, self.reason = "", "", ""
        self.passed = False
        self._moving_t = 0.0  # of the latest reference that did not ask to rest
        self._low_since: dict[int, float] = {}
        self._truth: SimTruth | None = None
        self._reference: MotionReference | None = None
        self._rest_n = np.zeros(4)  # largest force on each foot since the machine has come to rest

    @property
    def over(self) -> bool:
        """The run is decided."""
        reference = self._reference
        done = reference is not None and (reference.finished or reference.t - self._moving_t > _STOPPED_S)
        return bool(self.failure) or (self.passed and self._crosses) or done

    def on_reference(self, reference: MotionReference) -> None:
        """Take in what the state machine asks for."""
        self._reference = reference
        if reference.state != "STOPPED":
            self._moving_t = reference.t
            self._rest_n[:] = 0.0

    def on_truth(self, truth: SimTruth, tilt: float) -> None:
        """Take in the truth of one cycle, and the tilt that belongs to it [rad]."""
        self._truth = truth
        if tilt > FALL_TILT:
            self.failure = self.failure or "fell"
        elif any(part in truth.body_contact for part in ("trunk", "hip", "thigh")):
            self.failure, self.touching = self.failure or "contact", truth.body_contact
        beyond = (truth.p_WF[:, 0] > self._end_x) & (truth.force_W[:, 2] > CARRIES_N)
        self.passed = self.passed or bool(beyond.all())
        self._rest_n = np.maximum(self._rest_n, truth.force_W[:, 2])
        self._watch_holes(truth)

    def finish(self, t: float, limit_s: float) -> None:
        """Name the failure of a run that ended without success."""
        reference = self._reference
        finished = reference is not None and reference.finished
        if reference is not None and reference.state == "STOPPED":
            self.reason = reference.reason
        if self.failure:
            return
        if self._stops and (self.passed or finished):
            self.failure = "crossed"
        elif self._stops:
            self.failure = "" if self._rests_safely() else self._ended_short(t, limit_s)
        elif not self.passed and not (finished and not self._crosses):
            self.failure = self._ended_short(t, limit_s)

    @staticmethod
    def _ended_short(t: float, limit_s: float) -> str:
        return "timeout" if t >= limit_s else "stopped"

    def _rests_safely(self) -> bool:
        """At rest on four feet, and the press test says that the ground bears what each of them has borne."""
        truth, reference = self._truth, self._reference
        if truth is None or reference is None or reference.t - self._moving_t <= _STOPPED_S:
            return False
        return all(
            truth.force_W[leg, 2] > CARRIES_N
            and not self._gives_way(truth.p_WF[leg, :2], float(self._rest_n[leg]))
            for leg in range(4)
        )

    def _watch_holes(self, truth: SimTruth) -> None:
        """A foot stuck below the surface."""
        for leg in range(4):
            if self.depth(truth, leg) < BELOW_M:
                self._low_since.pop(leg, None)
            elif truth.t - self._low_since.setdefault(leg, truth.t) > STUCK_S:
                self.failure = self.failure or "stuck"

    def depth(self, truth: SimTruth, leg: int) -> float:
        """How far the centre of a foot is below the surface as it was built [m]."""
        x, _, z = truth.p_WF[leg].tolist()
        return self._field.level(x) - z
