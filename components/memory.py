"""What an object carries from one step to the next: named once in its class, read and put back from there.

A class says `memory = Memory("held_n", "told", state=State, course=Course)`. Names alone hold numbers, strings,
arrays, lists of these, or None. A name with a type holds an enumeration, a message, a set, a tuple or a dataclass,
or None instead; or a part, an object with a memory of its own, which is never replaced. An object that several
share is a part of one of them. What is read is plain enough for any msgpack library: it goes over a bus.

Nothing outside the part may hold a view of an array that is in its memory: arrays are replaced, not written to.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import fields, is_dataclass
from enum import Enum
from functools import lru_cache, partial
from typing import Any, NamedTuple

import numpy as np

from surefoot.bus.codec import decode, encode
from surefoot.bus.message import Message


class ForeignMemory(ValueError):
    """A memory that is not of this class: it was written by other code, or for another object."""


class _Form(NamedTuple):
    """How a value is written and read; of a part, only the class that names its memory."""

    write: Callable[[Any], Any]
    read: Callable[[Any], Any]
    part: Memory | None = None


class Memory:
    """The names of the attributes that a class's objects remember."""

    def __init__(self, *plain: str, **typed: type):
        """`plain` names hold values as they are; those in `typed` values of a type, or None."""
        self._forms = dict.fromkeys(plain, _PLAIN) | {name: _form(kind) for name, kind in typed.items()}

    @property
    def names(self) -> tuple[str, ...]:
        """Of the attributes."""
        return tuple(self._forms)

    def of(self, owner: object) -> dict[str, Any]:
        """What an object remembers, by name. Arrays are the object's own: to be packed before its next step."""
        return {name: form.write(getattr(owner, name)) for name, form in self._forms.items()}

    def restore(self, owner: object, state: dict[str, Any]) -> None:
        """Put back what `of` has read.

        Raises:
            ForeignMemory: names or values are not those of the object; nothing of it has changed.
        """
        for part, name, value in self._found(owner, state):
            setattr(part, name, value)

    def _found(self, owner: object, state: Any) -> list[tuple[object, str, Any]]:
        """All that is to be set."""
        kind = type(owner).__name__
        if not isinstance(state, dict) or state.keys() != self._forms.keys():
            given = ", ".join(map(str, state)) if isinstance(state, dict) else type(state).__name__
            raise ForeignMemory(f"a memory of {kind} holds {', '.join(self._forms)}, not {given:.400}")
        found: list[tuple[object, str, Any]] = []
        for name, form in self._forms.items():
            if form.part is not None:
                found += form.part._found(getattr(owner, name), state[name])
                continue
            try:
                found.append((owner, name, form.read(state[name])))
            except (ValueError, TypeError, AttributeError, RuntimeError) as error:
                raise ForeignMemory(f"{kind}.{name} cannot be {state[name]!r:.80}: {error}") from None
        return found


def _form(kind: type) -> _Form:
    memory = getattr(kind, "memory", None)
    if isinstance(memory, Memory):
        return _Form(memory.of, _as_it_is, memory)
    if issubclass(kind, Enum):
        return _or_none(lambda value: value.value, kind)
    if issubclass(kind, Message):
        return _or_none(_bytes_of, partial(decode, kind))
    if is_dataclass(kind):
        names = [field.name for field in fields(kind)]
        return _or_none(
            lambda value: {name: getattr(value, name) for name in names},
            lambda state: kind(**{name: _own(value) for name, value in state.items()}),
        )
    if kind in (set, tuple):
        return _or_none(sorted if kind is set else list, lambda values: kind(_own(value) for value in values))
    raise TypeError(f"no memory of a {kind.__name__}: give its class a memory, or remember its parts")


def _or_none(write: Callable[[Any], Any], read: Callable[[Any], Any]) -> _Form:
    return _Form(
        lambda value: None if value is None else write(value),
        lambda state: None if state is None else read(state),
    )


def _as_it_is(value: Any) -> Any:
    return value


def _own(value: Any) -> Any:
    """A value that nobody else holds."""
    if isinstance(value, np.ndarray):
        return value.copy()
    return [_own(each) for each in value] if isinstance(value, list) else value


# A message is frozen, and most of those remembered stay for many steps: each is encoded once.
_bytes_of = lru_cache(maxsize=32)(encode)

_PLAIN = _Form(_as_it_is, _own)
