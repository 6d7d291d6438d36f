"""How `surefoot run` shows a run: on a whole screen, or line by line, and a summary at the end."""

from __future__ import annotations

import re
import sys
import time
from collections.abc import Callable

from rich.console import Console, Group
from rich.live import Live

from surefoot.tools.diagnosis import why_nothing_moves
from surefoot.tools.picture import Picture
from surefoot.tools.startup.dialog import Dialog
from surefoot.tools.startup.keyboard import Keyboard
from surefoot.tools.status_screen import TOLD, event_line, process_table
from surefoot.tools.verdict import Verdict

_DRAW_S = 0.2
_LINE_S = 10.0
_WHY_S = 3.0


class StatusScreen:
    """The status on the whole screen; before that, line by line, the dialog of a guided start-up."""

    def __init__(self, drawn: Callable[[Picture], Group], dialog: Dialog | None):
        self._drawn, self._dialog = drawn, dialog
        self._keyboard = Keyboard(sys.stdin.fileno()) if dialog is not None else None
        # The screen wraps long lines; the console that prints on leaves that to the terminal.
        self._live = Live(console=Console(), screen=True, auto_refresh=False)
        self._last = 0.0

    def __enter__(self) -> StatusScreen:
        return self

    def __exit__(self, *_: object) -> None:
        self._live.stop()

    def __call__(self, picture: Picture) -> None:
        if self._dialog is not None and self._keyboard is not None and not self._dialog.over:
            self._dialog.look(picture, self._keyboard.line())
            return
        now = time.monotonic()
        if now - self._last >= _DRAW_S:
            self._last = now
            self._live.start()
            self._live.update(self._drawn(picture), refresh=True)


class StatusLines:
    """The status as lines, for a terminal that is none."""

    def __init__(self, console: Console):
        self._console = console
        self._events = self._notes = 0
        self._last = time.monotonic()
        self._said: dict[str, str] = {}
        self._why = self._why_said = ""
        self._why_since = 0.0

    def __call__(self, picture: Picture) -> None:
        say = self._console.print
        events, notes = list(picture.events), list(picture.notes)
        for event in events[self._events :]:
            if event.kind in TOLD:
                say(event_line(event), markup=False, highlight=False)
        for note in notes[self._notes :]:
            say(f"supervisor: {note}", markup=False, highlight=False)
        self._events, self._notes = len(events), len(notes)
        self._health(picture)
        self._why_nothing_moves(picture)
        now = time.monotonic()
        if picture.reference is not None and now - self._last >= _LINE_S:
            self._last = now
            say(
                f"{picture.t:8.2f} s  {picture.reference.state}, real-time factor "
                f"{picture.real_time_factor(recent=True):.2f}, {picture.counts['accepted']} footholds",
                highlight=False,
            )

    def _why_nothing_moves(self, picture: Picture) -> None:
        """The sentence when it has stood for a while and is another than the last."""
        why = why_nothing_moves(picture)
        words = re.sub(r"[\d.]+", "#", why)
        now = time.monotonic()
        if words != self._why:
            self._why, self._why_since = words, now
        elif why and words != self._why_said and now - self._why_since > _WHY_S:
            self._why_said = words
            self._console.print(f"{picture.t:8.2f} s  nothing moves: {why}", markup=False, highlight=False)
        if not why:
            self._why_said = ""

    def _health(self, picture: Picture) -> None:
        """A process's reason when it changes; a figure that counts up is no change."""
        for name, watched in picture.processes.items():
            reason = watched.status.reason if watched.status is not None else ""
            words = re.sub(r"[\d.]+", "#", reason)
            if words != self._said.get(name, ""):
                self._said[name] = words
                if reason:
                    self._console.print(f"{picture.t:8.2f} s  {name}: {reason}", markup=False, highlight=False)


def print_summary(console: Console, picture: Picture, reason: str, state: Verdict, log_dir: str) -> None:
    """What a run came to, when it is over."""
    counts, x = picture.counts, picture.estimate.p_WB[0] if picture.estimate is not None else 0.0
    collapses = counts["collapse"] + counts["late_collapse"]
    lines = [
        "",
        reason,
        f"{picture.t:.1f} s of the run's time, real-time factor {picture.real_time_factor():.2f}",
        f"{x:.2f} m forward, {counts['accepted']} footholds accepted, {collapses} collapses, "
        f"{counts['rejected']} candidates out of reach, largest displacement "
        f"{1e3 * picture.displacement_m:.0f} mm, {picture.restarts} restarts",
    ]
    if state.advice:
        lines.append(f"next: {state.advice}")
    lines.append(f"process logs: {log_dir}/")
    if not state.good:
        console.print(process_table(picture))
    console.print("\n".join(lines), markup=False, highlight=False)
