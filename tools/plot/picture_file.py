"""A figure as a file: PNG, SVG, or a small page that holds the SVG."""

from __future__ import annotations

import io
from html import escape
from pathlib import Path

from surefoot.config.typed_toml import ConfigError
from surefoot.tools.document import document, write_document
from surefoot.tools.reproduce.plots import Figure, save, styled

ENDINGS = (".png", ".svg", ".html")

_DPI = 150
_UNTOLD = dict.fromkeys(("Date", "Creator", "Format", "Type"))
"""Of a figure inside a page: it would only link to who defines such words."""


def check_ending(out: Path) -> None:
    """Say before the work that a picture cannot be written so.

    Raises:
        ConfigError: its ending is none of `ENDINGS`, or its folder is not there.
    """
    if out.suffix not in ENDINGS:
        raise ConfigError(f"--out {out}: a picture ends in {', '.join(ENDINGS)}")
    if not out.parent.is_dir():
        raise ConfigError(f"--out {out}: there is no folder {out.parent}; make it first")


def write_picture(figure: Figure, title: str, out: Path) -> None:
    """Write it in the form that its ending names; a page has the title above it."""
    with styled():
        if out.suffix == ".html":
            write_document(document(title, [f"<h1>{escape(title)}</h1>", inline_svg(figure, title)]), out)
        elif out.suffix == ".png":
            figure.savefig(out, dpi=_DPI)
        else:
            save(figure, out)


def inline_svg(figure: Figure, label: str) -> str:
    """The figure as an element of a page, which a browser scales and prints sharply."""
    text = io.StringIO()
    with styled():
        figure.savefig(text, format="svg", metadata=_UNTOLD)
    _, _, svg = text.getvalue().partition("<svg ")
    return f'<div class="wide"><svg role="img" aria-label="{escape(label)}" {svg}</div>'
