"""The panel beside the picture."""

from __future__ import annotations

import time

import viser

from surefoot.config.deployment import Deployment
from surefoot.tools.diagnosis import why_nothing_moves
from surefoot.tools.picture import Picture
from surefoot.tools.view import panel_text
from surefoot.tools.view.bus_source import BusSource
from surefoot.tools.view.heard import Heard
from surefoot.tools.view.layers import LAYERS
from surefoot.tools.view.settings_watch import SettingsWatch
from surefoot.tools.view.stage import Stage
from surefoot.tools.view.teleop_panel import TeleopPanel
from surefoot.tools.view.tuning_panel import TuningPanel

_WRITE_S = 0.25


class Panel:
    """Texts, kept up to date four times a second, and the switches of the layers.

    Attributes:
        hidden: layers that nobody wants to see.
        follows: the camera goes along with the robot.
    """

    def __init__(self, gui: viser.GuiApi, stage: Stage, running: BusSource | None):
        """Make the panel; controls that come before are above it.

        Args:
            gui: of the page.
            stage: whose layers are switched.
            running: whose robot can be commanded; None of a recording.
        """
        self.hidden: set[str] = set()
        self.follows = True
        self._stage = stage
        self._written = 0.0
        self._settings = SettingsWatch()
        self._alarm = gui.add_html("")
        self._machine = self._folder(gui, "State")
        self._press = self._folder(gui, "Probing: asked and held")
        self._tuning: TuningPanel | None = None
        if running is not None:
            TeleopPanel(gui, running)
            self._tuning = TuningPanel(gui, running)
        self._candidates = self._folder(gui, "Candidates")
        self._feet = self._folder(gui, "Feet")
        self._processes = self._folder(gui, "Processes", shut=True)
        self._events = self._folder(gui, "Events")
        self._add_switches(gui)
        with gui.add_folder("Legend", expand_by_default=False):
            gui.add_html(panel_text.legend())

    def write(
        self,
        heard: Heard,
        deployment: Deployment | None,
        picture: Picture | None,
        margin_m: float | None,
        pace: str,
        words: str,
    ) -> None:
        """Bring the texts up to date, if it is time to.

        Args:
            heard: what is known.
            deployment: of the run; None while it is not known.
            picture: of its processes; None where nobody tells of them.
            margin_m: of the support polygon; None while four feet stand [m].
            pace: in words how fast time goes.
            words: what is wrong with the source; empty when nothing is.
        """
        now = time.monotonic()
        if now - self._written < _WRITE_S:
            return
        self._written = now
        tunings = heard.history.tunings
        recorded = tunings[-1].assignment if tunings else ()
        self._settings.follow(deployment, picture.tuned if picture is not None else recorded)
        run = self._settings.run
        why = why_nothing_moves(picture) if picture is not None else ""
        self._alarm.content = panel_text.alarm(words or self._settings.trouble or why)
        self._processes.content = panel_text.processes(picture)
        if self._tuning is not None:
            self._tuning.write(run)
        if run is None:
            return
        self._machine.content = panel_text.machine(heard, run.now, margin_m, pace)
        self._press.content = panel_text.press(heard, run.now)
        self._feet.content = panel_text.feet(heard)
        self._candidates.content = panel_text.candidates(heard)
        self._events.content = panel_text.events(heard)

    def _folder(self, gui: viser.GuiApi, title: str, shut: bool = False) -> viser.GuiHtmlHandle:
        with gui.add_folder(title, expand_by_default=not shut):
            return gui.add_html("")

    def _add_switches(self, gui: viser.GuiApi) -> None:
        with gui.add_folder("Layers", expand_by_default=False):
            follow = gui.add_checkbox("camera goes along", True)

            @follow.on_update
            def _(event: viser.GuiEvent) -> None:
                self.follows = follow.value

            for layer, name in LAYERS.items():
                self._add_switch(gui, layer, name)

    def _add_switch(self, gui: viser.GuiApi, layer: str, name: str) -> None:
        box = gui.add_checkbox(name, True)

        @box.on_update
        def _(event: viser.GuiEvent) -> None:
            self._stage.set_visible(layer, box.value)
            (self.hidden.discard if box.value else self.hidden.add)(layer)
