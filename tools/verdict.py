"""When a run is over, whether it went well, and what to do next."""

from __future__ import annotations

from dataclasses import dataclass

from surefoot.hw.gate.gate import FREED_BY
from surefoot.tools.picture import Picture

_CROSSED = {"planks": "platform crossed", "slope": "platform crossed"}
"""What is said of a far side that has a name of its own."""

_AT_REST = ("DAMP", "HOLD", "SIT_DOWN")
"""States in which the robot is not meant to stand: a person has seen to it, or has not begun."""


@dataclass(frozen=True)
class Verdict:
    """How a run stands.

    Attributes:
        reason: in words; empty while there is nothing to say.
        over: the run ends.
        good: it went as it should.
        advice: what to do next; empty when there is nothing to do.
    """

    reason: str = ""
    over: bool = False
    good: bool = False
    advice: str = ""


def verdict(picture: Picture, terrain: str, seconds: float, interactive: bool) -> Verdict:
    """The verdict of the moment.

    The run is over when the goal is reached, the robot has fallen, lost its estimate or been damped by a person,
    or `seconds` of its time have passed (0: no limit). A robot that found no safe foothold stands and waits for a
    person, one whose gate has latched lies and does; where there is none, that ends the run too.

    Args:
        picture: what has been heard.
        terrain: its kind; a goal reached forward on any but flat ground is the other side. In a trap nothing ahead
            holds: to stop is what the robot should do.
        seconds: limit of the run's time.
        interactive: a person watches.
    """
    reference = picture.reference
    if reference is None:
        return Verdict()
    if reference.finished:
        crossed = terrain != "flat" and picture.direction == "forward"
        return Verdict(
            _CROSSED.get(terrain, f"{terrain} crossed") if crossed else "goal reached", over=True, good=True
        )
    if reference.state == "DAMP":
        if reference.reason == "commanded":  # it was not damped before: at the start nobody has commanded it
            return Verdict("damped by command", over=True, good=True)
        if "fallen" in reference.reason:
            advice = (
                "see the last events and the logs; `surefoot run` begins anew, `--set hw.seed=N` with other noise"
            )
            return Verdict(f"the robot fell: {reference.reason}", over=True, advice=advice)
        if reference.reason.startswith("state/estimate is"):
            advice = "see the health of the estimator above and its log"
            return Verdict(f"the robot was damped: {reference.reason}", over=True, advice=advice)
    if seconds and reference.t >= seconds:
        return Verdict("time is up", over=True, good=True)
    if reference.state == "STOPPED" and "commanded" not in reference.reason:
        advice = "`surefoot command backward` takes the robot back, left or right around, forward tries again"
        stopped = f"the robot stopped: {reference.reason}"
        return Verdict(stopped, over=not interactive, good=terrain == "trap", advice=advice)
    hardware = picture.hardware
    if reference.state not in _AT_REST and hardware is not None and hardware.damping and FREED_BY in hardware.gate:
        return Verdict(f"the gate damps the robot: {hardware.gate}", over=not interactive, advice=FREED_BY)
    return Verdict()
