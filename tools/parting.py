"""How a run ends whose robot stands on its own time: it sits down first, where it still can."""

from __future__ import annotations

import time
from collections.abc import Callable

from surefoot.bus.topics import TOPICS
from surefoot.config.deployment import Deployment
from surefoot.tools.picture import Picture

_CANNOT_SETTLE = ("io", "estimator", "wbc")
"""Without one of these the robot is damped by the gate, or not reached at all, before anybody could act."""

_MORE_S = 0.2  # after the controller has lowered the robot by itself


class Parting:
    """Has the robot sit down when the run is to end or has lost a process, and waits for it to be damped.

    Damped at once it would fall from its height, and towards a leg that is in the air or pressed. A simulated
    robot on simulated time needs no such care: there a run that is to end ends.
    """

    def __init__(
        self,
        deployment: Deployment,
        picture: Picture,
        command: Callable[[str], None],
        note: Callable[[str], None],
    ):
        """For one run; `command` reaches the robot, `note` tells the operator."""
        self._picture, self._command, self._note = picture, command, note
        wbc, run, at_hub = deployment.wbc, deployment.run, deployment.network.at_hub
        # Only the machine of io has the robot's end in its hand.
        self._settle_s = deployment.operator.settle_s if at_hub else 0.0
        lowered_s = TOPICS["fsm/reference"].stale_after_s + wbc.hold_s + wbc.lower_m / wbc.lower_speed
        self._alone_s = min(lowered_s + _MORE_S, self._settle_s)
        self._simulated, self._speed = run.clock == "simulated", run.speed
        self._catches = at_hub and (not self._simulated or deployment.hw.backend == "aliengo")
        self._until: float | None = None
        self._why = ""

    @property
    def settles(self) -> bool:
        """Whether a run that is to end now has the robot sit down first, which it does not do already."""
        return self._catches and not self._why and self._until is None and not self._settled

    def end(self, why: str) -> str:
        """Called in every look with why the run is to end, if it is: the first such reason, once the robot rests.

        Until then, and while there is none, "".
        """
        self._why = self._why or why
        if not self._why or not self._catches:
            return self._why
        return self._settle(self._why, self._settle_s, "the run is to end")

    def lost(self, name: str, what: str) -> str:
        """Called while a process is gone: why the run ends now, or "" while the robot settles."""
        if name in _CANNOT_SETTLE:
            return what
        if name == "fsm":
            return self._settle(what, self._alone_s, "")
        return self._settle(what, self._settle_s, f"{name} has ended")

    def _settle(self, what: str, seconds: float, reason: str) -> str:
        """`what` once the robot rests or has been waited for long enough; with a `reason` it is told to sit."""
        if self._settled:
            return what
        if self._until is None:
            self._until = self._now + seconds
            self._note(f"{what}; the robot sits down before the run ends")
            if reason:
                self._command(f"sit: {reason}")
        return what if self._now >= self._until else ""

    @property
    def _now(self) -> float:
        """On the clock that the robot sits down by [s]."""
        return self._picture.t if self._simulated else time.monotonic() * self._speed

    @property
    def _settled(self) -> bool:
        hardware, reference = self._picture.hardware, self._picture.reference
        if hardware is None or hardware.damping:
            return True  # it has not begun, or the gate has seen to it
        return reference is not None and reference.state == "DAMP"
