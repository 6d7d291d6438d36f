"""The page: one HTML file that needs nothing else, for a screen, a phone and paper."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from html import escape

from surefoot.tools.document import Part, Table, document, part_html, table_html
from surefoot.tools.reproduce.experiment import Experiment


@dataclass(frozen=True)
class Section:
    """An experiment with what it has shown.

    Attributes:
        experiment: which.
        parts: of its report.
        failed: why runs are missing, by name.
        results: of each arm, as in `results.json`.
    """

    experiment: Experiment
    parts: Sequence[Part]
    failed: dict[str, str]
    results: Sequence[dict] = ()


@dataclass(frozen=True)
class Page:
    """All that stands on the page.

    Attributes:
        command: that makes it again.
        quick: the short version.
        facts: version, seeds, settings, machine: (name, value).
        sections: in order.
        marks: (mark, asked, got, reached) of the evaluation; empty without.
        documents: (file, what it holds) of the data beside the page.
        columns: file name without ending, and (column, meaning) of each CSV.
    """

    command: str
    quick: bool
    facts: Sequence[tuple[str, str]]
    sections: Sequence[Section]
    marks: Sequence[Sequence[str]]
    documents: Sequence[tuple[str, str]]
    columns: dict[str, Sequence[tuple[str, str]]]

    def html(self) -> str:
        """The whole page."""
        parts = [
            "<h1>Load-bearing assessment by terrain probing, reproduced in simulation</h1>",
            '<p class="soft">The experiments of Medeiros et al., “Load-bearing Assessment for Safe Locomotion of '
            "Quadruped Robots on Collapsing Terrain” (Sec. III, Figs. 8–12), run with Surefoot in MuJoCo. The "
            "paper’s robot is a real Aliengo; here every figure comes from a simulated one with noise, delay and "
            "model error, and the simulator’s truth only grades.</p>",
        ]
        if self.quick:
            parts.append(
                '<p class="notice"><strong>Quick version.</strong> Few seeds, shorter walks, and crossings cut '
                "off after a few footholds. It shows what the experiments look like; it neither confirms nor "
                "refutes the paper’s figures. Leave out <code>--quick</code> for those.</p>"
            )
        parts.append(_contents(self.sections))
        parts += [_section(section) for section in self.sections]
        if self.marks:
            parts.append("<h2>Marks</h2>")
            marks = Table("What was asked of the stack, and what these runs give.", *self._marks_table())
            parts.append(table_html(marks, True))
        parts += ["<h2>Settings</h2>", table_html(Table("", ("what", "value"), self.facts), True)]
        parts += [f"<p>To make this page again:</p><pre>{escape(self.command)}</pre>", "<h2>Data</h2>"]
        parts.append(table_html(Table("Beside this page.", ("file", "what it holds"), self.documents), True))
        for name, columns in self.columns.items():
            parts.append(f"<details><summary>Columns of <code>{escape(name)}.csv</code></summary>")
            parts.append(table_html(Table("", ("column", "meaning"), columns), True) + "</details>")
        return document("Surefoot: the paper’s experiments", parts)

    def _marks_table(self) -> tuple[Sequence[str], Sequence[Sequence[str]]]:
        return ("mark", "asked", "got", ""), self.marks


def _contents(sections: Iterable[Section]) -> str:
    items = "".join(
        f'<li><a href="#{escape(each.experiment.name)}">{escape(each.experiment.title)}</a></li>'
        for each in sections
    )
    return f"<ul>{items}</ul>"


def _section(section: Section) -> str:
    experiment = section.experiment
    parts = [
        f'<h2 id="{escape(experiment.name)}">{escape(experiment.title)}</h2>',
        f"<blockquote><p>The paper: {escape(experiment.claim)}</p></blockquote>",
    ]
    parts += [part_html(part) for part in section.parts]
    if section.failed:
        items = "".join(
            f"<li>{escape(name)}: <code>{escape(why)}</code></li>" for name, why in section.failed.items()
        )
        parts.append(f'<p class="notice">Not run, or ended by an error:</p><ul>{items}</ul>')
    return "\n".join(parts)
