"""How a run in real time ends that has lost a process: the robot settles first, where it still can."""

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
    """Has the robot sit down when another process has ended, and waits for it to be damped.

    Damped at once it would fall towards a leg that is in the air or pressed.
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
        wbc, at_hub = deployment.wbc, deployment.network.at_hub
        # Only the machine of io has the robot's end in its hand.
        self._settle_s = deployment.operator.settle_s if at_hub else 0.0
        lowered_s = TOPICS["fsm/reference"].stale_after_s + wbc.hold_s + wbc.lower_m / wbc.lower_speed
        self._alone_s = min(lowered_s + _MORE_S, self._settle_s)
        self._until: float | None = None

    def lost(self, name: str, what: str) -> str:
        """Called while a process is gone: why the run ends now, or "" while the robot settles."""
        if name in _CANNOT_SETTLE or self._settled:
            return what
        if self._until is None:
            self._until = time.monotonic() + (self._alone_s if name == "fsm" else self._settle_s)
            self._note(f"{what}; the robot sits down before the run ends")
            if name != "fsm":
                self._command(f"sit: {name} has ended")
        return what if time.monotonic() >= self._until else ""

    @property
    def _settled(self) -> bool:
        hardware, reference = self._picture.hardware, self._picture.reference
        if hardware is None or hardware.damping:
            return True  # it has not begun, or the gate has seen to it
        return reference is not None and reference.state == "DAMP"
