"""A page of HTML that needs nothing else: for a screen, a phone and paper."""

from __future__ import annotations

from base64 import b64encode
from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from html import escape
from pathlib import Path

_MEDIA = {".svg": "image/svg+xml", ".jpg": "image/jpeg", ".png": "image/png"}

_GOOD, _BAD = ' class="yes"', ' class="no"'
_LOOKS = {"reached": _GOOD, "not reached": _BAD, "accepted": _GOOD, "collapse": _BAD}
"""Of cells with these words."""

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
.wide svg { display: block; width: 100%; height: auto; border-radius: 4px; background: #ffffff; }
.wide img, .wide svg { min-width: 38rem; }
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
  h2 { break-after: avoid; } .wide img, .wide svg { min-width: 0; } .row > div { flex-basis: 45%; } }
"""


@dataclass(frozen=True)
class Words:
    """A paragraph."""

    text: str


@dataclass(frozen=True)
class Table:
    """A table of text; the first column names its row."""

    caption: str
    head: Sequence[str]
    rows: Sequence[Sequence[str]]


@dataclass(frozen=True)
class Pictures:
    """One or more pictures in a row.

    Attributes:
        caption: of them all.
        files: SVG, PNG or JPEG.
        labels: of each, also read to who cannot see it.
        missing: why there are none.
    """

    caption: str
    files: Sequence[Path]
    labels: Sequence[str]
    missing: str = ""


Part = Words | Table | Pictures


def document(title: str, body: Iterable[str]) -> str:
    """The whole page: its title, and what stands on it as HTML."""
    text = "\n".join(body)
    return (
        '<!DOCTYPE html>\n<html lang="en">\n<head>\n<meta charset="utf-8">\n'
        '<meta name="viewport" content="width=device-width, initial-scale=1">\n'
        f"<title>{escape(title)}</title>\n<style>{_STYLE}</style>\n</head>\n"
        f"<body>\n<main>\n{text}\n</main>\n</body>\n</html>\n"
    )


def write_document(html: str, path: Path) -> None:
    """Write a page whole, or leave the old one."""
    partial = path.with_suffix(".part")
    partial.write_text(html, encoding="utf-8")
    partial.rename(path)


def part_html(part: Part) -> str:
    """A part of a page as HTML."""
    if isinstance(part, Words):
        return f"<p>{escape(part.text)}</p>"
    if isinstance(part, Table):
        return table_html(part)
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


def table_html(table: Table, words: bool = False) -> str:
    """A table as HTML: its figures to the right, or `words` to the left."""
    head = "".join(f'<th scope="col">{escape(each)}</th>' for each in table.head)
    rows = "".join("<tr>" + "".join(_cell(each) for each in row) + "</tr>" for row in table.rows)
    # Above the part that scrolls, so that a narrow screen shows all of it.
    caption = f"<figcaption>{escape(table.caption)}</figcaption>" if table.caption else ""
    kind = "words" if words else "figures"
    inner = f"<thead><tr>{head}</tr></thead><tbody>{rows}</tbody>"
    return f'<figure>{caption}<div class="scroll"><table class="{kind}">{inner}</table></div></figure>'


def _cell(text: str) -> str:
    look = _LOOKS.get(text, "")
    return f"<td{look}>{escape(text)}</td>"
