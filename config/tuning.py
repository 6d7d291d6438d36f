"""What a person changes of a deployment while the robot runs."""

from __future__ import annotations

import dataclasses
import difflib
import typing
from collections.abc import Iterator, Sequence
from functools import cache
from typing import Any

from surefoot.config.deployment import Deployment
from surefoot.config.typed_toml import ConfigError, Tunable, Within, convert, split_assignment


@dataclasses.dataclass(frozen=True)
class Setting:
    """One setting that can be tuned.

    Attributes:
        path: dotted, such as "wbc.kp".
        hint: its type, with its marks.
        limits: of each of its numbers; None for one that is on or off.
    """

    path: str
    hint: Any
    limits: Within | None

    @property
    def allowed(self) -> str:
        """The limits in words."""
        return "true or false" if self.limits is None else f"{self.limits.least:g} to {self.limits.most:g}"


@cache
def tunable_settings() -> dict[str, Setting]:
    """Every setting that can be tuned, by its path."""
    return {setting.path: setting for setting in _settings(Deployment, "")}


def tuned(deployment: Deployment, assignments: Sequence[str]) -> Deployment:
    """The deployment with some settings changed, as `--set` takes them.

    Raises:
        ConfigError: a setting is unknown or cannot be tuned; a value has the wrong type, is out of its limits or
            does not go with another.
    """
    for assignment in assignments:
        path, value = _read(assignment)
        deployment = _with(deployment, path.split("."), value, "")
    return deployment


def value_of(deployment: Deployment, path: str) -> Any:
    """A setting of a deployment, by its dotted path."""
    found: Any = deployment
    for name in path.split("."):
        found = getattr(found, name)
    return found


def assignment_of(deployment: Deployment, path: str) -> str:
    """`path=value` as `tuned` takes it."""
    return f"{path}={shown(value_of(deployment, path))}"


def shown(value: Any) -> str:
    """A value as TOML writes it."""
    if isinstance(value, bool):
        return str(value).lower()
    if isinstance(value, tuple):
        return f"[{', '.join(map(shown, value))}]"
    return repr(value)


class Tunings:
    """All that was changed of a deployment since its run began.

    Attributes:
        begun: the deployment that the run began with.
        assignments: each setting that was changed, with its value now, the latest change last.
    """

    def __init__(self, begun: Deployment):
        self.begun = begun
        self.assignments: tuple[str, ...] = ()

    def change(self, assignment: str) -> tuple[str, ...]:
        """Take in `path=value`; all assignments then.

        Raises:
            ConfigError: as `tuned`; nothing has changed.
        """
        path, _ = _read(assignment)
        others = [each for each in self.assignments if each.partition("=")[0] != path]
        now = tuned(self.begun, [*others, assignment])
        self.assignments = (*others, assignment_of(now, path))
        return self.assignments


def _read(assignment: str) -> tuple[str, Any]:
    path, given = split_assignment(assignment)
    settings = tunable_settings()
    if path not in settings:
        near = difflib.get_close_matches(path, settings, 1)
        guess = f"did you mean {near[0]}? " if near else ""
        raise ConfigError(
            f"{path}: not to be changed while the robot runs; {guess}`surefoot tune --list` tells what is, and a "
            f"run can begin with --set {assignment}"
        )
    return path, convert(settings[path].hint, given, path)


def _with(part: Any, names: list[str], value: Any, where: str) -> Any:
    name, *inner = names
    if inner:
        value = _with(getattr(part, name), inner, value, f"{where}.{name}".lstrip("."))
    try:
        return dataclasses.replace(part, **{name: value})
    except ConfigError as error:
        raise ConfigError(f"{where}: {error}" if where else str(error)) from None


def _settings(cls: type, where: str) -> Iterator[Setting]:
    hints = typing.get_type_hints(cls, include_extras=True)
    for field in dataclasses.fields(cls):
        hint, path = hints[field.name], f"{where}.{field.name}".lstrip(".")
        if dataclasses.is_dataclass(hint):
            yield from _settings(typing.cast(type, hint), path)
        elif any(isinstance(mark, Tunable) for mark in getattr(hint, "__metadata__", ())):
            yield Setting(path, hint, next(_limits(hint), None))


def _limits(hint: Any) -> Iterator[Within]:
    for mark in getattr(hint, "__metadata__", ()):
        if isinstance(mark, Within):
            yield mark
    for inner in typing.get_args(hint):
        yield from _limits(inner)
