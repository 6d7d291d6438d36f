"""The site of these pages: `make docs` builds it into build/docs and puts in what the code says of itself."""

from collections.abc import Callable

from sphinx.application import Sphinx

from surefoot.tools.cli import make_parser
from surefoot.tools.reference.commands_page import commands_page
from surefoot.tools.reference.settings_page import settings_page
from surefoot.tools.reference.topics_page import topics_page

project = "Surefoot"
extensions = ["myst_parser"]
myst_heading_anchors = 3
highlight_language = "text"
smartquotes = False  # "" is a value here

html_theme = "furo"
html_title = "Surefoot"
html_static_path = ["static"]
html_css_files = ["tables.css"]
html_show_copyright = False
html_show_sphinx = False
html_copy_source = False
html_theme_options = {
    "light_css_variables": {"color-brand-primary": "#a84e00", "color-brand-content": "#a84e00"},
    "dark_css_variables": {"color-brand-primary": "#ff9d47", "color-brand-content": "#ff9d47"},
}

GENERATED: dict[str, Callable[[], str]] = {
    "commands": lambda: commands_page(make_parser()),
    "settings": settings_page,
    "topics": topics_page,
}
"""What stands for a line `<!-- generated: NAME -->` of a page."""


def put_in(app: Sphinx, docname: str, source: list[str]) -> None:
    """Replace such lines of a page that is read."""
    for name, page in GENERATED.items():
        mark = f"<!-- generated: {name} -->"
        if mark in source[0]:
            source[0] = source[0].replace(mark, page())


def setup(app: Sphinx) -> None:
    """Called by Sphinx."""
    app.connect("source-read", put_in)
