"""Processes of a run that people run by hand for a while, such as under a debugger."""

from __future__ import annotations

import signal
from collections.abc import Callable, Iterator

from surefoot.tools.launcher import KILL_AFTER_S, end_process
from surefoot.tools.other_process import OtherProcess
from surefoot.tools.picture import Picture, Watched
from surefoot.tools.supervisor_messages import Answer


class Lending:
    """Which process is lent to whom (tools/borrowed_process.py is the other side of it)."""

    def __init__(self, picture: Picture, answer: Callable[[int, Answer], None], note: Callable[[str], None]):
        """`answer(pid, answer)` tells the process that asked; `note(words)` everybody."""
        self._picture, self._answer, self._note = picture, answer, note
        self._borrowers: dict[str, OtherProcess] = {}

    def lend(self, name: str, pid: int, refusal: Callable[[str], str]) -> None:
        """Leave a process to one that somebody runs by hand, until that one ends.

        Args:
            name: of the process.
            pid: of the one that asks for it.
            refusal: why a process cannot be replaced now, to follow its name; empty if it can.
        """
        try:
            borrower = OtherProcess(pid)
        except ProcessLookupError:
            self._note(f"cannot lend {name} to process {pid}: there is none")
            return
        if words := refusal(name):
            self._note(f"cannot lend {name} to process {pid}{words}")
            self._answer(pid, Answer(-1, f"the run does not lend {name}{words}"))
            borrower.close()
            return
        watched = self._picture.processes[name]
        end_process(watched.popen)
        watched.popen, watched.lent_to = None, pid
        self._borrowers[name] = borrower
        watched.begin_anew()
        self._answer(pid, Answer(watched.restarts))  # who borrowed it starts it
        self._note(f"{name} lent to process {pid}; it is started again here when that one ends")

    def returned(self) -> Iterator[tuple[Watched, int]]:
        """What was lent to a process that has ended, and that one's id."""
        for name, borrower in list(self._borrowers.items()):
            if borrower.gone:
                self._borrowers.pop(name).close()
                watched = self._picture.processes[name]
                watched.lent_to = 0
                yield watched, borrower.pid

    def end(self, watched: Watched) -> None:
        """Tell whoever has a process to end, if somebody does; one at a debugger's prompt is left there."""
        borrower = self._borrowers.pop(watched.name, None)
        if borrower is not None:
            watched.lent_to = 0
            borrower.signal(signal.SIGTERM)
            borrower.wait(KILL_AFTER_S)
            borrower.close()
