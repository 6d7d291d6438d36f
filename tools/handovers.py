"""Planned restarts on the monotonic clock: a process is ready before the one whose place it takes leaves it."""

from __future__ import annotations

import subprocess
from collections.abc import Callable, Iterator

from surefoot.tools.launcher import Launcher, end_process
from surefoot.tools.picture import Picture, Watched


class Handovers:
    """Successors that have been started and have not taken over yet (components/relief.py is their side of it)."""

    def __init__(self, picture: Picture, launcher: Launcher, note: Callable[[str], None]):
        self._picture, self._launcher, self._note = picture, launcher, note
        self._successors: dict[str, subprocess.Popen] = {}

    def __contains__(self, name: object) -> bool:
        return name in self._successors

    def begin(self, watched: Watched) -> None:
        """Start the successor of a process, which goes on until the other asks for its place."""
        self._successors[watched.name] = self._launcher.launch(watched.name, watched.restarts + 1, "--relieve")

    def settle(self) -> Iterator[tuple[str, str]]:
        """See which have taken over; the names of those that have failed to, and how they ended."""
        for name, successor in list(self._successors.items()):
            watched = self._picture.processes[name]
            if watched.exit_code == 0:
                watched.popen, watched.restarts = successor, watched.restarts + 1
                self._note(f"{name} restarted on request")
            elif (code := successor.poll()) is None:
                continue
            else:
                yield name, self._launcher.obituary(name, code)
            del self._successors[name]

    def end(self) -> None:
        """End every successor."""
        for successor in self._successors.values():
            end_process(successor)
