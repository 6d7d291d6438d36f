"""Every setting of a typed section: its default, what is allowed, its unit and what it is."""

from __future__ import annotations

import dataclasses
import math
import re
import types
import typing
from dataclasses import dataclass
from typing import Any

from surefoot.config.typed_toml import Within
from surefoot.tools.reference.notes import Note, notes, summary

_UNITS = {
    "rad_s": "rad/s",
    "hz": "Hz",
    "ms": "ms",
    "gb": "GB",
    "n2": "N^2",
    "deg": "deg",
    "m": "m",
    "s": "s",
    "n": "N",
}
"""By the end of a name; longer ends first."""

_IN_BRACKETS = re.compile(r"\s*\[([^\]]+)\]")
_KINDS = {float: "a number", int: "a whole number", bool: "true or false", str: "a text"}


@dataclass(frozen=True)
class Setting:
    """One key of a section.

    Attributes:
        name: of the key.
        default: as TOML; empty where one must be given.
        allowed: limits or choices, or the kind of value where neither is declared.
        unit: SI; empty for what has none.
        text: what it is.
        group: the heading under which it stands in the source.
    """

    name: str
    default: str
    allowed: str
    unit: str
    text: str
    group: str = ""


@dataclass(frozen=True)
class Section:
    """A table of TOML.

    Attributes:
        path: dotted; empty for the top level of a file.
        text: what it is for.
        settings: its own keys, in the order of the source.
    """

    path: str
    text: str
    settings: tuple[Setting, ...]


def sections(cls: type, path: str = "", default: Any = None) -> list[Section]:
    """A section and those inside it, in the order of the source.

    Args:
        cls: a dataclass of `surefoot.config`.
        path: dotted path of the table.
        default: an instance with the defaults; None for those of the class, where it has any.
    """
    hints, noted = typing.get_type_hints(cls, include_extras=True), notes(cls)
    own: list[Setting] = []
    inner: list[Section] = []
    for field in dataclasses.fields(cls):
        value = _default(field) if default is None else getattr(default, field.name)
        hint, where = hints[field.name], f"{path}.{field.name}" if path else field.name
        nested = _section_type(hint)
        if nested is not None:
            key = f"{where}{_more(hint)}"
            first, *deeper = sections(nested, key, value if dataclasses.is_dataclass(value) else None)
            text = f"{first.text} {noted[field.name].text}".strip()
            inner += [dataclasses.replace(first, text=text), *deeper]
        if nested is None or _more(hint):
            own.append(_setting(field.name, value, hint, noted[field.name]))
    return [Section(path, summary(cls), tuple(own)), *inner]


def _setting(name: str, value: Any, hint: Any, note: Note) -> Setting:
    unit = _IN_BRACKETS.search(note.text)
    suffix = next((_UNITS[end] for end in _UNITS if name.endswith(f"_{end}")), "")
    words = _IN_BRACKETS.sub("", note.text)
    default = "" if value is dataclasses.MISSING else as_toml(value)
    return Setting(name, default, _allowed(hint), unit[1] if unit else suffix, words, note.group)


def as_toml(value: Any) -> str:
    """A default as one would write it in a deployment."""
    if isinstance(value, bool):
        return str(value).lower()
    if isinstance(value, str):
        return f'"{value}"'
    if isinstance(value, float):
        return f"{value:g}"
    if isinstance(value, (tuple, list)):
        return f"[{', '.join(map(as_toml, value))}]"
    if isinstance(value, dict):
        return "{" + ", ".join(f"{key} = {as_toml(item)}" for key, item in value.items()) + "}"
    return "" if value is None else str(value)


def _default(field: dataclasses.Field) -> Any:
    if field.default_factory is not dataclasses.MISSING:
        return field.default_factory()
    return field.default


def _section_type(hint: Any) -> type | None:
    """The dataclass that a field holds: itself, one of a list or table of them, or perhaps."""
    if isinstance(hint, type) and dataclasses.is_dataclass(hint):
        return hint
    inside = (_section_type(each) for each in typing.get_args(hint))
    return next((each for each in inside if each is not None), None)


def _more(hint: Any) -> str:
    """What follows a key that holds several tables."""
    return {tuple: "[]", dict: ".NAME"}.get(typing.get_origin(hint), "")


def _allowed(hint: Any) -> str:
    origin, args = typing.get_origin(hint), typing.get_args(hint)
    if origin is typing.Annotated:
        return _within(args[1]) if isinstance(args[1], Within) else _allowed(args[0])
    if origin is typing.Literal:
        return ", ".join(f"`{as_toml(each)}`" for each in args)
    if origin in (typing.Union, types.UnionType):
        return next(_allowed(each) for each in args if each is not type(None))
    if origin is tuple:
        count = "a list" if args[-1] is Ellipsis else str(len(args))
        same = len({_allowed(each) for each in args if each is not Ellipsis}) == 1
        return f"{count} of: {_allowed(args[0])}" if same else "; ".join(map(_allowed, args))
    if origin is dict:
        return f"a table of: {_allowed(args[1])}"
    return _KINDS.get(hint, "a table")


def _within(limits: Within) -> str:
    if math.isinf(limits.most):
        return "any" if math.isinf(limits.least) else f"at least {limits.least:g}"
    return f"{limits.least:g} to {limits.most:g}"
