"""The page of every setting."""

from __future__ import annotations

from itertools import groupby

from surefoot.config.deployment import Deployment
from surefoot.config.reproduce import Reproduce
from surefoot.config.robot import Robot
from surefoot.config.unit import Unit
from surefoot.tools.reference.markdown import code, table
from surefoot.tools.reference.settings import Section, Setting, sections

_HEAD = ("setting", "default", "allowed", "unit", "what it is")


def settings_page() -> str:
    """Markdown: a deployment section by section, then the files that it names and the settings of `reproduce`."""
    parts = [
        ("A deployment", Deployment),
        ("A kind of robot: `config/robots/NAME.toml`", Robot),
        ("One robot: the file of `hw.unit`", Unit),
        ("`surefoot reproduce --set`", Reproduce),
    ]
    return "\n\n".join(f"## {title}\n\n{_part(cls)}" for title, cls in parts)


def _part(cls: type) -> str:
    return "\n\n".join(_told(section) for section in sections(cls))


def _told(section: Section) -> str:
    lines = [f"### `{section.path}`"] if section.path else []
    if section.text:
        lines.append(section.text)
    for group, settings in groupby(section.settings, key=lambda setting: setting.group):
        lines += [f"**{group.rstrip('.')}**"] if group else []
        lines.append(table(_HEAD, map(_cells, settings)))
    return "\n\n".join(lines)


def _cells(setting: Setting) -> tuple[str, ...]:
    return code(setting.name), code(setting.default), setting.allowed, setting.unit, setting.text
