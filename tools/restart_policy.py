"""Which process of a run may be replaced, and when."""

from __future__ import annotations

from collections.abc import Container

from surefoot.tools.picture import Picture

HOLDS_ROBOT = ("estimator", "wbc", "fsm")
"""On the monotonic clock these are restarted only while the robot rests: a few milliseconds pass without them.
The others may be at any time: the whole-body controller holds the base meanwhile."""

RESTS = ("DAMP", "STAND", "STOPPED")
"""States in which nothing moves."""


class RestartPolicy:
    """Says no to a restart that the robot, or somebody's debugger, would not stand."""

    def __init__(self, picture: Picture, under_way: Container[str]):
        """Judges by what is heard of the run, and by the hand-overs that are `under_way`."""
        self._picture, self._under_way = picture, under_way

    def refusal(self, name: str) -> str:
        """Why a process cannot be replaced now, to follow its name; empty if it can."""
        watched = self._picture.processes[name]
        if watched.host:
            return f": it is for the supervisor of {watched.host}"
        if name == "io":
            return ": it holds the robot and the bus; stop the run instead"
        if watched.lent_to:
            return f": it is lent to process {watched.lent_to}; end that one"
        if name in self._under_way:
            return ": it is being restarted already"
        if name in HOLDS_ROBOT and not self._picture.simulated and self._picture.state not in RESTS:
            return (
                f" in state {self._picture.state or 'unknown'}: in real time nothing waits for it; "
                "`surefoot command stop` or sit first"
            )
        return ""

    def can_spare(self, name: str) -> bool:
        """Whether the robot can be without a process that is ended before the next one is there."""
        return name not in HOLDS_ROBOT or self._picture.state == "DAMP"
