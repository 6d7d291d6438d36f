"""Reads TOML into frozen dataclasses: every key known, every type checked, every error with its path."""

from __future__ import annotations

import dataclasses
import difflib
import math
import tomllib
import types
import typing
from operator import attrgetter
from pathlib import Path
from typing import Annotated, Any, TypeVar


class ConfigError(ValueError):
    """A configuration that cannot be used; says which key, its value and what would be right."""


@dataclasses.dataclass(frozen=True)
class Within:
    """Limits of a number, both allowed: `gain: Annotated[float, Within(0.0, 500.0)]`."""

    least: float = -math.inf
    most: float = math.inf


@dataclasses.dataclass(frozen=True)
class Tunable:
    """Mark of a setting that a person may change while the robot runs.

    It is read anew where it is used, and nothing that has begun counts on its old value. Limits of the safety
    gate, and those at which the robot is damped, are never tunable.
    """


_T = TypeVar("_T")

Tuned = Annotated[_T, Tunable()]
"""The mark beside the limits: `gain: Tuned[Annotated[float, Within(0.0, 500.0)]]`, or `Tuned[Force]`."""


def read_toml(path: Path) -> dict[str, Any]:
    """Parse a TOML file.

    Raises:
        ConfigError: the file is missing or is not TOML.
    """
    try:
        with open(path, "rb") as file:
            return tomllib.load(file)
    except FileNotFoundError:
        raise ConfigError(f"no such file: {path}; give the path of a TOML file") from None
    except IsADirectoryError:
        raise ConfigError(f"{path} is a folder; give the path of a TOML file") from None
    except UnicodeDecodeError as error:
        raise ConfigError(f"{path} is not a text file: {error}") from None
    except tomllib.TOMLDecodeError as error:
        raise ConfigError(f"{path} is not valid TOML: {error}") from None


def build(cls: type, table: Any, path: str = "") -> Any:
    """Make a dataclass of type `cls` from a TOML table.

    Args:
        cls: a dataclass; fields without default are required.
        table: what TOML holds there.
        path: dotted path of the table, for messages.

    Raises:
        ConfigError: unknown key, missing key, wrong type or out of limits, named by its dotted path.
    """
    where = path or "the top level"
    if not isinstance(table, dict):
        raise ConfigError(f"{where}: expected a table, got {table!r}")
    hints = typing.get_type_hints(cls, include_extras=True)
    fields = {field.name: field for field in dataclasses.fields(cls) if field.init}
    for key in table:
        if key not in fields:
            near = difflib.get_close_matches(key, fields, 1)
            guess = f"did you mean {_join(path, near[0])}? " if near else ""
            raise ConfigError(f"{_join(path, key)}: unknown key; {guess}{where} has {', '.join(sorted(fields))}")
    values = {}
    for name, field in fields.items():
        if name in table:
            given = table[name]
            if dataclasses.is_dataclass(field.default) and isinstance(given, dict):
                given = to_table(field.default) | given  # what a part of a section leaves out stays as it is
            values[name] = convert(hints[name], given, _join(path, name))
        elif field.default is dataclasses.MISSING and field.default_factory is dataclasses.MISSING:
            raise ConfigError(f"{_join(path, name)}: missing; {where} must give it")
    try:
        return cls(**values)
    except ConfigError as error:
        raise ConfigError(f"{path}: {error}" if path else str(error)) from None


def ordered(config: Any, low: str, high: str, why: str) -> None:
    """Refuse a configuration in which the figure `low` is above the figure `high`; both may be dotted paths.

    Raises:
        ConfigError: names both with their values, and `why` that cannot be.
    """
    least, most = attrgetter(low)(config), attrgetter(high)(config)
    if least > most:
        raise ConfigError(f"{low} = {least} is above {high} = {most}: {why}; lower the one or raise the other")


def split_assignment(assignment: str) -> tuple[str, Any]:
    """Path and value of `a.b.c=value`; the value is TOML, or a bare word taken as a string.

    Raises:
        ConfigError: it is no assignment.
    """
    dotted, equals, text = assignment.partition("=")
    if not equals or not dotted.strip():
        raise ConfigError(f"--set {assignment!r}: write it as section.key=value")
    try:
        return dotted.strip(), tomllib.loads(f"value = {text}")["value"]
    except tomllib.TOMLDecodeError:
        return dotted.strip(), text


def with_override(table: dict[str, Any], assignment: str) -> dict[str, Any]:
    """A copy of `table` with one `a.b.c=value` applied, as `split_assignment` reads it."""
    dotted, value = split_assignment(assignment)
    keys = dotted.split(".")
    result = dict(table)
    inner = result
    for key in keys[:-1]:
        table_there = inner.get(key, {})
        if not isinstance(table_there, dict):
            raise ConfigError(f"--set {assignment!r}: {key} is {table_there!r}, not a section")
        inner[key] = dict(table_there)
        inner = inner[key]
    inner[keys[-1]] = value
    return result


def to_table(value: Any) -> Any:
    """The plain tables, lists and numbers behind a dataclass: what a log or a results file holds."""
    if dataclasses.is_dataclass(value):
        return {f.name: to_table(getattr(value, f.name)) for f in dataclasses.fields(value)}
    if isinstance(value, dict):
        return {key: to_table(item) for key, item in value.items()}
    if isinstance(value, (tuple, list)):
        return [to_table(item) for item in value]
    return value


def without_unknown(cls: type, table: dict[str, Any], path: str = "") -> tuple[dict[str, Any], list[str]]:
    """What this version knows of a table that another version wrote.

    Args:
        cls: the dataclass it is for.
        table: as `to_table` made it.
        path: dotted path of the table.

    Returns:
        The table without keys that `cls` has not, and without those that are None; the paths of the former.
    """
    hints = typing.get_type_hints(cls)
    known: dict[str, Any] = {}
    unknown: list[str] = []
    for key, value in table.items():
        where = _join(path, key)
        if key not in hints:
            unknown.append(where)
        elif value is not None:
            inner = next(
                (each for each in (hints[key], *typing.get_args(hints[key])) if dataclasses.is_dataclass(each)),
                None,
            )
            if inner is not None and isinstance(value, dict):
                value, more = without_unknown(typing.cast(type, inner), value, where)
                unknown += more
            known[key] = value
    return known, unknown


def _join(path: str, key: str) -> str:
    return f"{path}.{key}" if path else key


def convert(hint: Any, value: Any, path: str) -> Any:
    """A value as TOML gives it, as the type of a field wants it.

    Raises:
        ConfigError: it has another type, or is out of limits; named by its dotted path.
    """
    origin, args = typing.get_origin(hint), typing.get_args(hint)
    if origin is typing.Annotated:
        value = convert(args[0], value, path)
        return next((_limited(value, mark, path) for mark in args[1:] if isinstance(mark, Within)), value)
    if origin in (typing.Union, types.UnionType):
        return convert(next(arg for arg in args if arg is not type(None)), value, path)
    if origin is typing.Literal:
        if value not in args:
            raise ConfigError(f"{path} = {value!r}: must be one of {', '.join(map(repr, args))}")
        return value
    if origin is dict:
        if not isinstance(value, dict):
            raise ConfigError(f"{path}: expected a table, got {value!r}")
        return {key: convert(args[1], item, _join(path, key)) for key, item in value.items()}
    if origin is tuple:
        return _convert_tuple(args, value, path)
    if isinstance(hint, type) and dataclasses.is_dataclass(hint):
        return build(hint, value, path)
    if hint is float and isinstance(value, int) and not isinstance(value, bool):
        return float(value)
    if not isinstance(value, hint) or (hint is not bool and isinstance(value, bool)):
        raise ConfigError(f"{path} = {value!r}: expected {hint.__name__}")
    if hint is float and not math.isfinite(value):
        raise ConfigError(f"{path} = {value}: expected a finite number")
    return value


def _limited(value: Any, limits: Within, path: str) -> Any:
    if not limits.least <= value <= limits.most:
        raise ConfigError(f"{path} = {value!r}: out of range, allowed {limits.least:g} to {limits.most:g}")
    return value


def _convert_tuple(args: tuple, value: Any, path: str) -> tuple:
    if not isinstance(value, list):
        raise ConfigError(f"{path} = {value!r}: expected a list")
    if len(args) == 2 and args[1] is Ellipsis:
        return tuple(convert(args[0], item, f"{path}[{i}]") for i, item in enumerate(value))
    if len(value) != len(args):
        raise ConfigError(f"{path} = {value!r}: expected {len(args)} entries, got {len(value)}")
    return tuple(convert(arg, item, f"{path}[{i}]") for i, (arg, item) in enumerate(zip(args, value, strict=True)))
