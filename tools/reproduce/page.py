"""The page: one HTML file that needs nothing else, for a screen, a phone and paper."""

from __future__ import annotations

from base64 import b64encode
from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from html import escape
from pathlib import Path

from surefoot.tools.reproduce.experiment import Experiment, Part, Pictures, Table, Words

_MEDIA = {".svg": "image/svg+xml", ".jpg": "image/jpeg", ".png": "image/png"}

_STYLE = """
:root { --ink: #1d2126; --soft: #5c6570; --line: #d9dde2; --ground: #ffffff; --card: #f5f6f8; --mark: #1f5fbf;
  --good: #1c7a3c; --bad: #b3261e; color-scheme: light dark; }
@media (prefers-color-scheme: dark) { :root { --ink: #e6e9ed; --soft: #a3acb7; --line: #3a414a;
  --ground: #15181c; --card: #1f242a; --mark: #7fb0ff; --good: #62c987; --bad: #ff8a80; } }
* { box-sizing: border-box; }
body { margin: 0; background: var(--ground); color: var(--ink);
  font: 16px/1.55 system-ui, -apple-system, "Segoe UI", Roboto, "Helvetica Neue", Arial, sans-serif; }
main { max-width: 66rem; margin: 0 auto; padding: 2rem 1.1rem 4rem; }
h1 { font-size: 1.75rem; line-height: 1.2; margin: 0 0 .4rem; }
h2 { font-size: 1.25rem; line-height: 1.3; margin: 3rem 0 .6rem; padding-top: .8rem;
  border-top: 1px solid var(--line); }
p, blockquote, ul { max-width: 46rem; }
a { color: var(--mark); }
.soft, figcaption { color: var(--soft); font-size: .9rem; }
.notice { background: var(--card); border-left: 4px solid var(--mark); padding: .7rem 1rem; max-width: 46rem; }
blockquote { margin: 0 0 1rem; padding: .1rem 0 .1rem 1rem; border-left: 4px solid var(--line);
  color: var(--soft); }
figure { margin: 1.2rem 0; }
.row { display: flex; flex-wrap: wrap; gap: .8rem; }
.row > div { flex: 1 1 19rem; min-width: 0; }
.row.one > div { flex-basis: 100%; } .row > .shot { max-width: 36rem; }
.row.even > div { flex-basis: 26rem; }
.wide { overflow-x: auto; }
img { display: block; width: 100%; height: auto; border-radius: 4px; background: #ffffff; }
.wide img { min-width: 38rem; }
.label { font-size: .85rem; margin: .3rem 0 0; }
.scroll { overflow-x: auto; }
table { border-collapse: collapse; font-size: .9rem; font-variant-numeric: tabular-nums; }
figcaption { max-width: 46rem; }
table.figures td { white-space: nowrap; }
th, td { text-align: right; padding: .3rem .7rem; border-bottom: 1px solid var(--line); vertical-align: top; }
th:first-child, td:first-child { text-align: left; padding-left: 0; }
table.words th, table.words td { text-align: left; }
thead th { color: var(--soft); font-weight: 600; }
code, pre { font: .85em/1.45 ui-monospace, SFMono-Regular, Menlo, Consolas, monospace; }
pre { background: var(--card); padding: .8rem 1rem; overflow-x: auto; border-radius: 4px; }
.yes { color: var(--good); } .no { color: var(--bad); }
@media print { :root { --ink: #000; --soft: #444; --line: #bbb; --ground: #fff; --card: #f3f3f3; }
  body { font-size: 10.5pt; } main { max-width: none; padding: 0; } figure { break-inside: avoid; }
  .scroll, .wide { overflow: visible; }
  h2 { break-after: avoid; } .wide img { min-width: 0; } .row > div { flex-basis: 45%; } }
"""


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
            parts.append(
                _table(Table("What was asked of the stack, and what these runs give.", *self._marks_table()), True)
            )
        parts += ["<h2>Settings</h2>", _table(Table("", ("what", "value"), self.facts), True)]
        parts += [f"<p>To make this page again:</p><pre>{escape(self.command)}</pre>", "<h2>Data</h2>"]
        parts.append(_table(Table("Beside this page.", ("file", "what it holds"), self.documents), True))
        for name, columns in self.columns.items():
            parts.append(f"<details><summary>Columns of <code>{escape(name)}.csv</code></summary>")
            parts.append(_table(Table("", ("column", "meaning"), columns), True) + "</details>")
        body = "\n".join(parts)
        return (
            '<!DOCTYPE html>\n<html lang="en">\n<head>\n<meta charset="utf-8">\n'
            '<meta name="viewport" content="width=device-width, initial-scale=1">\n'
            f"<title>Surefoot: the paper’s experiments</title>\n<style>{_STYLE}</style>\n</head>\n"
            f"<body>\n<main>\n{body}\n</main>\n</body>\n</html>\n"
        )

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
    parts += [_part(part) for part in section.parts]
    if section.failed:
        items = "".join(
            f"<li>{escape(name)}: <code>{escape(why)}</code></li>" for name, why in section.failed.items()
        )
        parts.append(f'<p class="notice">Not run, or ended by an error:</p><ul>{items}</ul>')
    return "\n".join(parts)


def _part(part: Part) -> str:
    if isinstance(part, Words):
        return f"<p>{escape(part.text)}</p>"
    if isinstance(part, Table):
        return _table(part)
    return _pictures(part)


def _pictures(part: Pictures) -> str:
    caption = f"<figcaption>{escape(part.caption)}</figcaption>"
    if not part.files:
        return f'<figure>{caption}<p class="notice">{escape(part.missing or "nothing to show")}</p></figure>'
    plot = all(file.suffix == ".svg" for file in part.files)
    cells = []
    for file, label in zip(part.files, part.labels, strict=True):
        source = f"data:{_MEDIA[file.suffix]};base64,{b64encode(file.read_bytes()).decode()}"
        image = f'<img src="{source}" alt="{escape(label)}">'
        told = "" if plot else f'<p class="label">{escape(label)}</p>'
        cells.append(f'<div class="{"wide" if plot else "shot"}">{image}{told}</div>')
    kind = " one" if plot else " even" if len(part.files) % 2 == 0 else ""
    return f'<figure><div class="row{kind}">{"".join(cells)}</div>{caption}</figure>'


def _table(table: Table, words: bool = False) -> str:
    head = "".join(f'<th scope="col">{escape(each)}</th>' for each in table.head)
    rows = "".join("<tr>" + "".join(_cell(each) for each in row) + "</tr>" for row in table.rows)
    # Above the part that scrolls, so that a narrow screen shows all of it.
    caption = f"<figcaption>{escape(table.caption)}</figcaption>" if table.caption else ""
    kind = "words" if words else "figures"
    inner = f"<thead><tr>{head}</tr></thead><tbody>{rows}</tbody>"
    return f'<figure>{caption}<div class="scroll"><table class="{kind}">{inner}</table></div></figure>'


def _cell(text: str) -> str:
    look = {"reached": ' class="yes"', "not reached": ' class="no"'}.get(text, "")
    return f"<td{look}>{escape(text)}</td>"


def write_page(page: Page, path: Path) -> None:
    """Write the page whole, or leave the old one."""
    partial = path.with_suffix(".part")
    partial.write_text(page.html(), encoding="utf-8")
    partial.rename(path)
