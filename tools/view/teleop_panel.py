"""Buttons that command the robot of a running stack, and the answer to each."""

from __future__ import annotations

from collections.abc import Callable

import viser

from surefoot.components.fsm.words import Answer
from surefoot.tools.teleop.remote import Remote
from surefoot.tools.view.bus_source import BusSource
from surefoot.tools.view.panel_text import answer

_PAD: tuple[dict[str, tuple[float, float]], ...] = (
    {"↖": (0.7, 0.7), "↑": (1.0, 0.0), "↗": (0.7, -0.7)},
    {"←": (0.0, 1.0), "halt": (0.0, 0.0), "→": (0.0, -1.0)},
    {"↙": (-0.7, 0.7), "↓": (-1.0, 0.0), "↘": (-0.7, -0.7)},
)
"""Directions in the trunk, x ahead and y to the left, as an arrow has them that is seen from behind the robot."""


def _walk(to: tuple[float, float]) -> Callable[[Remote], Answer]:
    return (lambda remote: remote.direction(*to)) if any(to) else Remote.halt


_ROWS: tuple[tuple[str, dict[str, Callable[[Remote], Answer]]], ...] = (
    *(("walk", {name: _walk(to) for name, to in row.items()}) for row in _PAD),
    ("step", {"pause": Remote.pause, "resume": Remote.resume, "step once": Remote.step_once}),
    ("foothold", {"skip": Remote.skip_foothold, "re-probe": Remote.reprobe}),
    ("robot", {"stand": Remote.stand, "sit": Remote.sit, "stop": Remote.stop, "damp": Remote.damp}),
)
"""Each row of buttons with its name, and what each button does."""


class TeleopPanel:
    """A remote control on the page; its commands go the way of every operator's, and may be refused."""

    def __init__(self, gui: viser.GuiApi, source: BusSource):
        """Make the buttons; until a stack is there they say that there is none."""
        self._source = source
        with gui.add_folder("Command"):
            for name, does in _ROWS:
                self._add_row(gui, name, does)
            cut = gui.add_button("CUT: no torque, the robot falls", color="red")
            self._answer = gui.add_html("")

        @cut.on_click
        def _(event: viser.GuiEvent) -> None:
            self._say("cut", Remote.cut)

    def _add_row(self, gui: viser.GuiApi, name: str, does: dict[str, Callable[[Remote], Answer]]) -> None:
        row = gui.add_button_group(name, tuple(does))

        @row.on_click
        def _(event: viser.GuiEvent) -> None:
            self._say(row.value, does[row.value])

    def _say(self, words: str, command: Callable[[Remote], Answer]) -> None:
        """In one of viser's threads, not in that which draws: an answer may take seconds."""
        remote = self._source.remote
        if remote is None:
            self._answer.content = answer(words, False, "no stack runs")
            return
        self._answer.content = answer(words, True, "…")
        got = command(remote)
        self._answer.content = answer(words, got.taken, got.words)
