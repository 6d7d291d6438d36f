"""Restarts that have been asked for and not yet been carried out."""

from __future__ import annotations

import time
from collections.abc import Callable

from surefoot.tools.diagnosis import awaited
from surefoot.tools.picture import Picture


class RestartQueue:
    """One restart after the other: a process that comes up asks the others for their last messages.

    What is asked for again meanwhile is done once. A process that simulated time waits for goes first: nobody else
    comes up before it.
    """

    def __init__(self, picture: Picture, patience_s: float, clock: Callable[[], float] = time.monotonic):
        """After `patience_s` a process that is not up again no longer holds up the others."""
        self._picture, self._patience_s, self._clock = picture, patience_s, clock
        self._due: dict[str, str] = {}
        self._last, self._begun = "", 0.0

    def add(self, name: str, why: str) -> str:
        """Ask for a restart; what there is to say about it now, or ""."""
        if name in self._due:
            return ""
        self._due[name] = why
        return f"{name} is restarted as soon as {self._last} is up again" if self._busy else ""

    def next(self) -> tuple[str, str] | None:
        """The process to be restarted now and why, or None."""
        name = awaited(self._picture)
        if name not in self._due:
            if not self._due or self._busy:
                return None
            name = next(iter(self._due))
        self._last, self._begun = name, self._clock()
        return name, self._due.pop(name)

    @property
    def _busy(self) -> bool:
        """Whether the process that was restarted last is still coming up."""
        if not self._last or self._clock() - self._begun > self._patience_s:
            return False
        watched = self._picture.processes[self._last]
        if watched.out or watched.lent_to:
            return False
        status = watched.status
        return status is None or (status.nominal_hz > 0.0 and status.steps == 0)
