"""Settings of a running stack, changed from the page as `surefoot tune` changes them."""

from __future__ import annotations

import viser

from surefoot.components.fsm.words import Answer, refused
from surefoot.config.deployment import Deployment
from surefoot.config.tuning import shown, tunable_settings, value_of
from surefoot.tools.reference.settings import sections
from surefoot.tools.teleop.tuned_run import TunedRun
from surefoot.tools.view import panel_text
from surefoot.tools.view.bus_source import BusSource
from surefoot.tools.view.tuning_field import TuningField

_FILE = "tuned.toml"
_PUT_BACK, _SAVE = "put back", "save"


class TuningPanel:
    """A folder with every setting that can be tuned, one table of the deployment at a time.

    A change is a request on the bus like any other: checked by io, recorded, and refused with its words. What is
    shown comes from the bus too, whoever has changed it.
    """

    def __init__(self, gui: viser.GuiApi, source: BusSource):
        """Make it; it is seen as soon as a run is known."""
        self._source = source
        self._run: TunedRun | None = None
        self._told: TuningField | None = None
        self._folder = gui.add_folder("Tuning", expand_by_default=False, visible=False)
        with self._folder:
            self._changed = gui.add_html("")
            every = gui.add_button_group("changed", (_PUT_BACK, _SAVE))
            self._answer = gui.add_html("")
            tables = sorted({path.rpartition(".")[0] for path in tunable_settings()})
            self._table = gui.add_dropdown("section", tables)
            about = _about()
            self._fields = {table: self._add_fields(gui, table, about) for table in tables}

        @self._table.on_update
        def _(event: viser.GuiEvent) -> None:
            for table, (folder, _) in self._fields.items():
                folder.visible = table == self._table.value

        @every.on_click
        def _(event: viser.GuiEvent) -> None:
            if every.value == _PUT_BACK:
                self._put_back()
            elif event.client is not None:
                self._save(event.client)

    def write(self, run: TunedRun | None) -> None:
        """Bring it up to date; None where no run is known."""
        self._run = run
        self._folder.visible = run is not None
        if run is None:
            return
        self._changed.content = panel_text.changed(run)
        for field in self._fields[self._table.value][1]:
            field.write(run)

    def _add_fields(
        self, gui: viser.GuiApi, table: str, about: dict[str, str]
    ) -> tuple[viser.GuiFolderHandle, list[TuningField]]:
        folder, usual = gui.add_folder(None, visible=table == self._table.value), Deployment()
        with folder:
            return folder, [
                TuningField(gui, setting, value_of(usual, path), about[path], self._set)
                for path, setting in tunable_settings().items()
                if path.rpartition(".")[0] == table
            ]

    def _set(self, field: TuningField) -> None:
        """In one of viser's threads, not in that which draws: an answer may take seconds."""
        if self._told is not None:
            self._told.tell("")
        self._told, typed = field, field.typed
        asked = f"{field.path}={shown(typed)}"
        field.tell(panel_text.answer(asked, True, "…"))
        got = self._tune(field.path, typed)
        field.tell(panel_text.answer(asked, got.taken, got.words))
        if not got.taken and field.typed == typed:
            field.spring_back()

    def _tune(self, path: str, value: float | bool | tuple[float, ...]) -> Answer:
        remote = self._source.remote
        return refused("no stack runs") if remote is None else remote.tune(path, value)

    def _put_back(self) -> None:
        """All that differs from the run's beginning, the latest first."""
        run = self._run
        if run is None:
            return
        self._answer.content = panel_text.answer(_PUT_BACK, True, "…")
        for path in reversed(run.changed):
            got = self._tune(path, value_of(run.begun, path))
            if not got.taken:
                self._answer.content = panel_text.answer(_PUT_BACK, False, got.words)
                return
        self._answer.content = panel_text.answer(_PUT_BACK, True, "all is as the run began")

    def _save(self, client: viser.ClientHandle) -> None:
        """To whoever asks, by way of the browser: the page writes no file on the machine that serves it."""
        run = self._run
        if run is None:
            return
        client.send_file_download(_FILE, run.file_text().encode(), save_immediately=True)
        told = f"{len(run.changed)} settings differ in {_FILE}, which the browser keeps"
        self._answer.content = panel_text.answer(_SAVE, True, told)


def _about() -> dict[str, str]:
    """Of every setting, by its path, what it is and its unit, as the page of settings has it."""
    told = {}
    for section in sections(Deployment):
        for setting in section.settings:
            text = (setting.text or section.text.partition("\n")[0]).rstrip(".")
            unit = f" [{setting.unit}]" if setting.unit else ""
            told[f"{section.path}.{setting.name}"] = f"{text}{unit}"
    return told
