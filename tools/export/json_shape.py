"""What a message is in JSON, and the schema that says so.

No list holds another: Foxglove refuses a topic whose schema does. Where the places of an array have names it is an
object, `p_WF.FL.z`; what else would be a list of lists has objects for rows, `covariance[3].row[4]`.
"""

from __future__ import annotations

import json
from collections.abc import Callable, Sequence
from functools import cache
from typing import Any

import numpy as np

from surefoot.bus.message import FieldSpec, Message, specs
from surefoot.bus.recording.json_schema import schema_of
from surefoot.tools.tables.column_names import axis_names

_ROW = "row"
_JSON_TYPE = {"bool": "boolean", "int64": "integer", "uint8": "integer"}
"""Of the numbers in an array; others are "number"."""

Axes = Sequence[tuple[str, ...]]
"""Names along each axis of an array; none: it is a list."""

_Shapes = list[tuple[str, Axes, bool]]
"""Name, axes and whether it is always finite, of each field of a message."""


def to_json(message: Message) -> bytes:
    """A message as a JSON object; what is not a number is null."""
    fields = {name: _value(getattr(message, name), axes, finite) for name, axes, finite in _fields(type(message))}
    return json.dumps(fields, allow_nan=False).encode()


def plain_json_schema(cls: type[Message]) -> bytes:
    """The schema of what `to_json` makes of a message."""
    return schema_of(cls, _array_schema)


def _shapes(cls: type[Message]) -> _Shapes:
    return [
        (name, axis_names(name, spec) if spec.kind == "array" else (), spec.finite)
        for name, spec in specs(cls).items()
    ]


# As in `bus.codec`: a `type` is hashable to mypy, a `type[Message]` is not.
_fields: Callable[[type], _Shapes] = cache(_shapes)


def _value(value: Any, axes: Axes, finite: bool) -> Any:
    if isinstance(value, np.ndarray):
        if not finite and not np.isfinite(value).all():
            told = value.astype(object)
            told[~np.isfinite(value)] = None
            value = told
        return _folded(value.tolist(), axes)
    if isinstance(value, float) and not np.isfinite(value):
        return None
    return value


def _folded(values: list, axes: Axes) -> Any:
    """A list of lists with objects in it instead."""
    names, *inner = axes
    if inner:
        values = [_folded(each, inner) for each in values]
    if names:
        return dict(zip(names, values, strict=True))
    if inner and not inner[0]:
        return [{_ROW: each} for each in values]
    return values


def _array_schema(field: str, spec: FieldSpec) -> dict[str, Any]:
    schema: dict[str, Any] = {"type": _JSON_TYPE.get(spec.dtype, "number")}
    for names, length in zip(reversed(axis_names(field, spec)), reversed(spec.shape), strict=True):
        schema = _object(dict.fromkeys(names, schema)) if names else _list(schema, length)
    return schema


def _list(item: dict[str, Any], length: int) -> dict[str, Any]:
    """Of so many; -1: any number."""
    entry = {"type": "array", "items": _object({_ROW: item}) if item["type"] == "array" else item}
    return entry | ({"minItems": length, "maxItems": length} if length >= 0 else {})


def _object(properties: dict[str, Any]) -> dict[str, Any]:
    return {"type": "object", "properties": properties}
