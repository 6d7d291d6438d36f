"""Messages to bytes and back: one msgpack map, arrays as raw little-endian bytes, everything checked."""

from __future__ import annotations

import reprlib
from collections.abc import Callable
from functools import cache
from math import isfinite
from typing import Any, NoReturn, TypeVar

import msgpack
import numpy as np

from surefoot.bus.errors import MessageError
from surefoot.bus.message import FieldSpec, Message, specs

_TYPE = "message"
"""The field that says which message it is: unknown fields are ignored, missing ones blank; any map would do."""

_LITTLE = {"float64": "<f8", "float32": "<f4", "int64": "<i8", "uint8": "u1", "bool": "?"}

_LONGEST = 2**31 - 1
"""Of an axis: the product with a zero beside it says nothing of the others."""

M = TypeVar("M", bound=Message)

_Plan = tuple[tuple[str, FieldSpec, np.dtype | None], ...]


def _make_plan(cls: type[Message]) -> _Plan:
    return tuple(
        (name, spec, np.dtype(_LITTLE[spec.dtype]) if spec.kind == "array" else None)
        for name, spec in specs(cls).items()
    )


# `cache` takes what is Hashable: mypy grants that to a `type`, but not to a `type[Message]`.
_plan: Callable[[type], _Plan] = cache(_make_plan)


def encode(message: Message, volatile: bool = True) -> bytes:
    """Bytes of a message.

    Args:
        message: any message of `bus.messages`.
        volatile: include measurements of the machine; without them equal runs give equal bytes.

    Raises:
        MessageError: a field's shape or type is not the declared one.
    """
    fields: dict[str, Any] = {_TYPE: type(message).__name__}
    for name, spec, dtype in _plan(type(message)):
        if spec.volatile and not volatile:
            continue
        value = getattr(message, name)
        if dtype is not None:
            value = np.asarray(value)
            if value.dtype != dtype:
                value = value.astype(dtype, casting="same_kind")
            _check_shape(type(message), name, spec, value.shape)
            if -1 in spec.shape:
                fields[name] = [list(value.shape), value.tobytes()]
            else:
                fields[name] = value.tobytes()
        elif spec.kind == "number":
            fields[name] = float(value)
        elif spec.kind == "integer":
            fields[name] = int(value)
        elif spec.kind == "flag":
            fields[name] = bool(value)
        elif spec.kind == "names":
            fields[name] = list(value)
        else:
            fields[name] = value
    return msgpack.packb(fields)


def decode(cls: type[M], data: bytes) -> M:
    """The message in `data`; arrays are read-only views of it. Fields this version does not know are ignored.

    Raises:
        MessageError: not msgpack, another message, a wrong type or shape, or a number that is not finite, by
            field name.
    """
    try:
        fields = msgpack.unpackb(data)
    except Exception as error:
        raise MessageError(f"{cls.__name__}: not msgpack ({error!s:.80}); {len(data)} bytes dropped") from None
    if not isinstance(fields, dict):
        raise MessageError(f"{cls.__name__}: expected a map of fields, got {type(fields).__name__}")
    if fields.get(_TYPE) != cls.__name__:
        raise MessageError(f"{cls.__name__}: the field {_TYPE!r} says {_shown(fields.get(_TYPE))}: another type")
    values = {}
    for name, spec, dtype in _plan(cls):
        if name in fields:
            values[name] = _decode_field(cls, name, spec, dtype, fields[name])
    return cls(**values)


def check(message: M) -> M:
    """The same message, if every number in it is finite and every shape as declared.

    Raises:
        MessageError: naming the field, its value and what is expected.
    """
    for name, spec, dtype in _plan(type(message)):
        value = getattr(message, name)
        if dtype is not None:
            # Compared whole first: a message is checked at every publication, and this is what it costs.
            if getattr(value, "shape", None) != spec.shape:
                _check_shape(type(message), name, spec, np.shape(value))
            if spec.finite and not _all_finite(value):
                _refuse_not_finite(type(message), name, value)
        elif spec.finite and spec.kind == "number" and not isfinite(value):
            _refuse_not_finite(type(message), name, value)
    return message


_PYTHON: dict[str, tuple[Any, ...]] = {
    "number": (float, int),
    "integer": (int,),
    "flag": (bool,),
    "text": (str,),
    "names": (list,),
}
"""What msgpack gives of each kind, as `isinstance` takes it; `Any`: mypy cannot know which kind is at hand."""


def _decode_field(cls: type, name: str, spec: FieldSpec, dtype: np.dtype | None, value: Any) -> Any:
    if dtype is None:
        expected = _PYTHON[spec.kind]
        if not isinstance(value, expected) or (isinstance(value, bool) and spec.kind != "flag"):
            _refuse(cls, name, _shown(value), f"expected {expected[0].__name__}")
        if spec.kind == "names":
            if not all(isinstance(item, str) for item in value):
                _refuse(cls, name, _shown(value), "expected strings only")
            return tuple(value)
        if spec.kind == "number":
            value = float(value)
            if spec.finite and value - value != 0.0:
                _refuse(cls, name, value, "not finite")
        return value
    shape = spec.shape
    if -1 in shape:
        if not (isinstance(value, list) and len(value) == 2 and isinstance(value[0], list)):
            _refuse(cls, name, _shown(value), "expected [shape, bytes]")
        shape, value = value
        if not all(type(n) is int and 0 <= n <= _LONGEST for n in shape):
            _refuse(cls, name, f"shape {_shown(shape)}", f"expected a list of lengths up to {_LONGEST}")
        _check_shape(cls, name, spec, tuple(shape))
    if not isinstance(value, bytes):
        _refuse(cls, name, _shown(value), "expected bytes")
    count = 1
    for n in shape:
        count *= n
    if len(value) != count * dtype.itemsize:
        _refuse(cls, name, f"{len(value)} bytes", f"expected {count * dtype.itemsize} for {list(shape)}")
    result = np.frombuffer(value, dtype).reshape(shape)
    if dtype.kind == "f":
        if spec.finite and not _all_finite(result):
            _refuse_not_finite(cls, name, result)
    elif dtype.kind == "b" and value.translate(None, b"\0\1"):
        # numpy takes such a byte for what it is told, and counts or inverts it wrongly.
        _refuse(cls, name, _shown(value), "expected bytes 0 and 1")
    return result


def _all_finite(values: np.ndarray) -> bool:
    """Whether all numbers are; one that is not makes the sum of squares none, which is quicker to ask for."""
    return isfinite(np.vdot(values, values)) or bool(np.isfinite(values).all())  # squares may overflow


def _check_shape(cls: type, name: str, spec: FieldSpec, shape: tuple[int, ...]) -> None:
    if len(shape) != len(spec.shape) or any(a not in (-1, b) for a, b in zip(spec.shape, shape, strict=True)):
        _refuse(cls, name, f"shape {_shown(shape)}", f"expected {spec.shape}")


def _refuse(cls: type, name: str, value: Any, why: str) -> NoReturn:
    raise MessageError(f"{cls.__name__}.{name} = {value}: {why}")


def _refuse_not_finite(cls: type, name: str, value: Any) -> NoReturn:
    """Names the first number that is none."""
    values = np.asarray(value)
    place = tuple(np.argwhere(~np.isfinite(values))[0].tolist())
    _refuse(cls, name + (str(list(place)) if place else ""), values[place], "not finite")


def _shown(value: Any) -> str:
    """A value of any size and depth in a few characters of one line."""
    return reprlib.repr(value)[:80]
