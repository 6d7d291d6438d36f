"""Many messages of one type as one array a field."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from typing import Any

import msgpack
import numpy as np

from surefoot.bus.errors import MessageError
from surefoot.bus.message import FieldSpec, Message, specs

_KINDS: dict[str, tuple[type, Any]] = {
    "number": (float, 0.0),
    "integer": (np.int64, 0),
    "flag": (bool, False),
    "text": (object, ""),
    "names": (object, ()),
}
"""What a field of each kind becomes, and what stands where a message of an older version has none."""


def columns(cls: type[Message], payloads: Iterable[bytes], fields: Sequence[str]) -> dict[str, np.ndarray]:
    """Decode messages all at once; the first axis of every array is the message.

    A field of one shape in all messages becomes one array with that shape behind the first axis; where shapes
    differ, an array of arrays. Fields that the messages do not have are blank.

    Args:
        cls: their type.
        payloads: their bytes.
        fields: names of its fields.

    Raises:
        MessageError: a message is not of this type, or a field of it is not as declared.
    """
    raw: dict[str, list[Any]] = {name: [] for name in fields}
    adders = [(name, values.append) for name, values in raw.items()]
    for number, payload in enumerate(payloads):
        try:
            found = msgpack.unpackb(payload)
            kind = found["message"]
        except Exception as error:
            raise MessageError(f"{cls.__name__}, message {number}: not msgpack ({error!s:.80})") from None
        if kind != cls.__name__:
            raise MessageError(f"{cls.__name__}, message {number}: is a {kind!s:.40}")
        for name, add in adders:
            add(found.get(name))
    known = specs(cls)
    return {name: _column(cls, name, known[name], values) for name, values in raw.items()}


def _column(cls: type[Message], name: str, spec: FieldSpec, values: list[Any]) -> np.ndarray:
    try:
        if spec.kind == "array":
            return _open(spec, values) if -1 in spec.shape else _fixed(spec, values)
        dtype, blank = _KINDS[spec.kind]
        return _scalars(dtype, [blank if value is None else value for value in values])
    except (ValueError, TypeError) as error:
        raise MessageError(f"{cls.__name__}.{name}: not as declared ({error})") from None


def _scalars(dtype: type, values: list[Any]) -> np.ndarray:
    if dtype is not object:
        return np.array(values, dtype)
    column = np.empty(len(values), object)
    column[:] = [tuple(value) if isinstance(value, list) else value for value in values]
    return column


def _fixed(spec: FieldSpec, values: list[bytes | None]) -> np.ndarray:
    dtype = np.dtype(spec.dtype).newbyteorder("<")
    blank = bytes(dtype.itemsize * int(np.prod(spec.shape)))
    joined = bytearray().join(blank if value is None else value for value in values)
    return np.frombuffer(joined, dtype).reshape(len(values), *spec.shape)


def _open(spec: FieldSpec, values: list[list | None]) -> np.ndarray:
    dtype = np.dtype(spec.dtype).newbyteorder("<")
    blank: list[Any] = [[max(n, 0) for n in spec.shape], b""]
    told = [blank if value is None else value for value in values]
    shapes = {tuple(shape) for shape, _ in told}
    if len(shapes) == 1:
        (shape,) = shapes
        return np.frombuffer(bytearray().join(data for _, data in told), dtype).reshape(len(told), *shape)
    column = np.empty(len(told), object)
    for number, (shape, data) in enumerate(told):
        column[number] = np.frombuffer(bytearray(data), dtype).reshape(shape)
    return column
