"""The page of a run: from how it ended, over its way and its probes, to the settings it was made with."""

from __future__ import annotations

import json
from collections.abc import Callable, Iterator
from html import escape
from pathlib import Path

from surefoot.bus.errors import RecordingError
from surefoot.config.typed_toml import ConfigError
from surefoot.tools.document import Table, document, table_html, write_document
from surefoot.tools.picture import Picture
from surefoot.tools.plot.catalogue import DRAWINGS, draw
from surefoot.tools.plot.choice import Choice
from surefoot.tools.plot.picture_file import inline_svg
from surefoot.tools.plot.probes import Probe, find_probes
from surefoot.tools.status_screen import TOLD, event_line
from surefoot.tools.story.ending import ending, picture_at_the_end
from surefoot.tools.story.probe_table import probe_table
from surefoot.tools.story.settings import own_settings
from surefoot.tools.tables.recording_tables import RecordingTables
from surefoot.tools.verdict import Verdict

_LAST_EVENTS = 8

_VERSIONS = {
    "made": "made",
    "how": "how",
    "version": "version",
    "source": "digest of the sources",
    "numerics": "arithmetic of the machine",
}


def write_story(recording: RecordingTables, out: Path, say: Callable[[str], None] = lambda line: None) -> Path:
    """Write the page of a recording; returns where it is.

    Args:
        recording: of any run; what it does not hold is left out and told.
        out: a file ending in .html, or a folder for index.html.
        say: told of each picture.

    Raises:
        ConfigError: `out` is neither.
        NotRecorded: there is nothing of the state machine in it.
    """
    path = _page_file(out)
    story = Story(recording, say)
    write_document(document(story.title, story.body()), path)
    return path


def _page_file(out: Path) -> Path:
    if out.suffix == ".html":
        if not out.parent.is_dir():
            raise ConfigError(f"--out {out}: there is no folder {out.parent}; make it first")
        return out
    if out.suffix:
        raise ConfigError(f"--out {out}: a page ends in .html; without an ending it is a folder for index.html")
    try:
        out.mkdir(parents=True, exist_ok=True)
    except OSError as error:
        raise ConfigError(f"--out {out}: no folder can be made there ({error.strerror})") from None
    return out / "index.html"


class Story:
    """All that the page tells of one recording.

    Attributes:
        title: of the page.
    """

    def __init__(self, recording: RecordingTables, say: Callable[[str], None]):
        self._recording, self._say = recording, say
        self._terrain = recording.deployment.terrain.kind
        self._probes: list[Probe] = find_probes(recording)
        self._picture: Picture = picture_at_the_end(recording)
        self._ending: Verdict = ending(self._picture, self._terrain)
        self.title = f"{recording.path.name}: {self._ending.reason}"

    def body(self) -> Iterator[str]:
        """The page from top to bottom, as HTML."""
        yield f"<h1>{escape(self._ending.reason[0].upper() + self._ending.reason[1:])}</h1>"
        begin, end = self._recording.span_s
        versions = self._recording.versions
        yield (
            f'<p class="soft">{escape(self._recording.path.name)}, {begin:.1f} to {end:.1f} s on the run’s clock; '
            f"terrain {escape(self._terrain)}; recorded {escape(versions.get('made', 'at an unknown time'))} with "
            f"version {escape(versions.get('version', 'unknown'))}.</p>"
        )
        yield self._missing()
        yield table_html(Table("", ("", ""), self._facts()), words=True)
        yield from self._section("path", "The way", "As the robot estimated it; the terrain as it was built.")
        yield from self._section("states", "What the robot did", "Each row is a part of the run.")
        yield "<h2>Probes</h2>"
        yield (
            table_html(probe_table(self._probes), words=True)
            if self._probes
            else "<p>No foot was set down to probe.</p>"
        )
        yield from self._why()
        yield from self._closely()
        yield from self._section("support", "Support", "While a foot is in the air or presses, three carry.")
        yield from self._section("estimator", "Estimate and truth", "Estimate less what the simulator knows.")
        yield from self._section("timing", "Step times", "Dotted: the time after which an output is late.")
        yield from self._settings()

    # Parts ----------------------------------------------------------------------------------------------

    def _missing(self) -> str:
        found = self._recording.missing
        if not found:
            return ""
        items = "".join(f"<li>{escape(words)}</li>" for words in found)
        return f'<div class="notice"><strong>What is missing.</strong><ul>{items}</ul></div>'

    def _facts(self) -> list[tuple[str, str]]:
        counts, begin_end = self._picture.counts, self._recording.span_s
        way = self._recording.read("state/estimate", ("p_WB",))["p_WB"]
        accepted = sum(probe.verdict == "accepted" for probe in self._probes)
        late = counts["late_collapse"]
        return [
            ("duration", f"{begin_end[1] - begin_end[0]:.1f} s"),
            ("trunk", f"{way[-1, 0] - way[0, 0]:+.2f} m ahead, {way[-1, 1] - way[0, 1]:+.2f} m to the left"),
            ("footholds", f"{accepted} accepted of {len(self._probes)} that a foot was set on"),
            ("collapses", f"{counts['collapse']} in probes" + (f", {late} of trusted footholds" if late else "")),
            ("largest force held", f"{max((probe.held_n for probe in self._probes), default=0.0):.0f} N"),
            ("largest displacement", f"{1e3 * self._picture.displacement_m:.0f} mm"),
            ("told to", self._picture.command or "–"),
        ]

    def _section(self, what: str, heading: str, caption: str, choice: Choice | None = None) -> Iterator[str]:
        """A picture under a heading; nothing where the recording does not hold what it shows."""
        self._say(f"drawing {what}")
        try:
            figure = draw(self._recording, what, choice or Choice())
        except RecordingError as error:
            self._say(f"left out: {error}")
            return
        svg = inline_svg(figure, DRAWINGS[what].title)
        yield f"<h2>{escape(heading)}</h2>"
        yield f"<figure>{svg}<figcaption>{escape(caption)}</figcaption></figure>"

    def _why(self) -> Iterator[str]:
        yield "<h2>Why it ended</h2>"
        advice = f" Next: {self._ending.advice}." if self._ending.advice else ""
        yield f"<p>{escape(self._ending.reason[0].upper() + self._ending.reason[1:] + '.' + advice)}</p>"
        told = [
            event_line(event).strip()
            for event in self._picture.events
            if event.kind in TOLD and event.kind != "contact"
        ]
        if told:
            lines = escape("\n".join(told[-_LAST_EVENTS:]))
            yield f"<p>The last of what the state machine told:</p><pre>{lines}</pre>"

    def _closely(self) -> Iterator[str]:
        """The first collapse, or else the first probe."""
        pressed = [probe for probe in self._probes if probe.presses]
        if not pressed:
            return
        shown = next((probe for probe in pressed if probe.verdict == "collapse"), pressed[0])
        heading = "The first collapse" if shown.verdict == "collapse" else "The first probe"
        caption = (
            f"Probe {shown.number}, {shown.verdict}: {shown.reason}. Time from contact; the other three feet and "
            "the centre of mass from above; the margin from lift-off on; the force over the foot's displacement."
        )
        yield from self._section("probing", heading, caption, Choice(number=shown.number))

    def _settings(self) -> Iterator[str]:
        yield "<h2>Settings and versions</h2>"
        rows = own_settings(self._recording.config)
        caption = "Settings other than the defaults." if rows else "All settings are the defaults."
        yield table_html(Table(caption, ("setting", "value", "default"), rows), words=True)
        versions = self._recording.versions
        facts = [(label, versions[name]) for name, label in _VERSIONS.items() if name in versions]
        yield table_html(Table("", ("recording", ""), facts), words=True)
        whole = escape(json.dumps(self._recording.config, indent=1))
        yield f"<details><summary>The whole configuration</summary><pre>{whole}</pre></details>"
