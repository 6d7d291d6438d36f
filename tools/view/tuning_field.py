"""One setting that can be tuned, on the page."""

from __future__ import annotations

import math
from collections.abc import Callable
from typing import Any

import viser

from surefoot.config.tuning import Setting, shown, value_of
from surefoot.config.typed_toml import Within
from surefoot.tools.teleop.tuned_run import TunedRun

_DECIMALS = 7  # may be typed: the least of all limits above zero is 1e-6
_MARK = "● "


class TuningField:
    """Inputs of a setting, one for each of its numbers, and a button that sets it to what they say.

    An input tells every key that is pressed, and keeps the last digit where all are deleted: nothing is sent but
    by the button, and that is what its label says. Inputs have no limits of their own, which would make another
    value of one that is out of them; it is refused, in words.

    Attributes:
        path: of the setting.
    """

    def __init__(
        self, gui: viser.GuiApi, setting: Setting, usual: Any, about: str, ask: Callable[[TuningField], None]
    ):
        """Make them.

        Args:
            gui: of the page, in the folder where they are to be.
            setting: which.
            usual: its value by default, to begin with.
            about: what it is, and its unit.
            ask: called in one of viser's threads when it is to be set to `typed`.
        """
        self.path = setting.path
        self._about = f"{about}; allowed: {setting.allowed}"
        self._now = usual
        self._run: TunedRun | None = None
        name = setting.path.rpartition(".")[2]
        numbers = _numbers(usual)
        self._names = [f"{name}[{i}]" for i in range(len(numbers))] if isinstance(usual, tuple) else [name]
        self._inputs = [_add_input(gui, *each, setting.limits) for each in zip(self._names, numbers, strict=True)]
        self._button = gui.add_button("", visible=False)
        self._answer = gui.add_html("")

        @self._button.on_click
        def _(event: viser.GuiEvent) -> None:
            offered, self._button.label = self._button.label, self._offer()
            if self._button.label == offered:
                ask(self)

    @property
    def typed(self) -> Any:
        """The value that stands in the inputs."""
        numbers = tuple(each.value for each in self._inputs)
        return numbers if isinstance(self._now, tuple) else numbers[0]

    def write(self, run: TunedRun) -> None:
        """Show what the run goes by, mark what differs from its beginning, and offer to set what was typed."""
        if run is not self._run:
            self._run = run
            self._follow(run)
        typed = self.typed != self._now
        self._button.visible = typed
        if typed:
            self._button.label = self._offer()

    def spring_back(self) -> None:
        """Show again what the run goes by."""
        for each, number in zip(self._inputs, _numbers(self._now), strict=True):
            each.value = number  # type: ignore[misc]  # viser sends what is set

    def tell(self, html: str) -> None:
        """What became of it."""
        self._answer.content = html

    def _follow(self, run: TunedRun) -> None:
        now, begun = value_of(run.now, self.path), value_of(run.begun, self.path)
        if now != self._now:
            self._now = now
            self.spring_back()
        texts = zip(self._inputs, self._names, _numbers(now), _numbers(begun), strict=True)
        for each, name, number, first in texts:
            each.label = name if number == first else f"{_MARK}{name}"
            each.hint = f"{self._about}; the run began with {shown(first)}"

    def _offer(self) -> str:
        """What the button would do; of a list all its numbers, short enough for one line of a narrow panel."""
        if isinstance(self._now, tuple):
            return f"set [{', '.join(f'{number:.10g}' for number in self.typed)}]"
        return f"set {self._names[0]} = {shown(self.typed)}"


def step_of(usual: float, limits: Within) -> float:
    """What one click on an input's arrows changes: a tenth of the leading decimal place; 1 of a whole number.

    Args:
        usual: the setting's value by default; of 0 the largest allowed tells the size.
        limits: of the setting.
    """
    if isinstance(usual, int):
        return 1
    return float(f"1e{math.floor(math.log10(abs(usual) or limits.most)) - 1}")


def _numbers(value: Any) -> tuple[Any, ...]:
    return value if isinstance(value, tuple) else (value,)


def _add_input(
    gui: viser.GuiApi, name: str, value: float | bool, limits: Within | None
) -> viser.GuiInputHandle[Any]:
    if limits is None:
        return gui.add_checkbox(name, bool(value))
    number = gui.add_number(name, value, step=step_of(value, limits))
    number.precision = 0 if isinstance(value, int) else _DECIMALS
    return number
