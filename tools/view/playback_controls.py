"""The controls of a recording: time, pause, pace."""

from __future__ import annotations

import time
from collections.abc import Callable

import viser

from surefoot.tools.view.recording_source import RecordingSource

_SPEEDS = ("0.1", "0.25", "0.5", "1", "2", "5", "10")
_STEP_S = 0.01
_FRAME_S = 0.02
_WRITE_S = 0.25


class PlaybackControls:
    """What a person does with the time of a recording; done between two pictures, by the loop that draws them."""

    def __init__(self, gui: viser.GuiApi, source: RecordingSource):
        """Make them."""
        self._source = source
        self._written = 0.0
        self._wanted: list[Callable[[], None]] = []
        with gui.add_folder("Recording"):
            self._time = gui.add_slider(
                "time [s]", source.begin_t, max(source.end_t, source.begin_t + _STEP_S), _STEP_S, source.t
            )
            self._play = gui.add_button("pause", icon=viser.Icon.PLAYER_PAUSE)
            speed = gui.add_dropdown("speed", _SPEEDS, initial_value="1")
            verdict = gui.add_button_group("verdict", ("◀ before", "next ▶"))
            frame = gui.add_button_group("20 ms", ("◀ back", "on ▶"))

        @self._time.on_update
        def _(event: viser.GuiEvent) -> None:
            if event.client is not None:  # not what `write` has set
                self._wanted.append(lambda: source.seek(self._time.value))

        @self._play.on_click
        def _(event: viser.GuiEvent) -> None:
            self._wanted.append(self._toggle)

        @speed.on_update
        def _(event: viser.GuiEvent) -> None:
            source.speed = float(speed.value)

        @verdict.on_click
        def _(event: viser.GuiEvent) -> None:
            ahead = verdict.value == "next ▶"
            self._wanted.append(lambda: self._go(lambda: source.leap(ahead)))

        @frame.on_click
        def _(event: viser.GuiEvent) -> None:
            step = _FRAME_S if frame.value == "on ▶" else -_FRAME_S
            self._wanted.append(lambda: self._go(lambda: source.seek(source.t + step)))

    def obey(self) -> None:
        """Do what was clicked since the last picture."""
        wanted, self._wanted = self._wanted, []
        for each in wanted:
            each()
            self._written = 0.0

    def write(self) -> None:
        """Show where time is."""
        now, source = time.monotonic(), self._source
        if now - self._written < _WRITE_S:
            return
        self._written = now
        self._time.value = source.t  # type: ignore[misc]  # viser sends what is set
        self._play.label = "pause" if source.playing else "play"
        self._play.icon = viser.Icon.PLAYER_PAUSE if source.playing else viser.Icon.PLAYER_PLAY

    def _toggle(self) -> None:
        source = self._source
        if not source.playing and source.t >= source.end_t:
            source.seek(source.begin_t)
        source.playing = not source.playing

    def _go(self, somewhere: Callable[[], None]) -> None:
        self._source.playing = False
        somewhere()
