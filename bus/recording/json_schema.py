"""The JSON schema of a message type, for readers of recordings that do not have this program."""

from __future__ import annotations

import json
from collections.abc import Callable, Mapping
from typing import Any

from surefoot.bus.message import FieldSpec, Message, specs

_JSON_TYPE = {"number": "number", "integer": "integer", "flag": "boolean", "text": "string"}


ArraySchema = Callable[[str, FieldSpec], dict[str, Any]]
"""Of a field that is an array, by its name and specification."""


def json_schema(cls: type[Message]) -> bytes:
    """The schema of the msgpack map that `bus.codec` makes of a message.

    An array is a byte string: `dtype` says how to read it, `shape` how to fold it (-1: any length; then the
    field is a list of the real shape and the bytes).
    """
    return schema_of(cls, _array, {"message": {"const": cls.__name__}})


def schema_of(cls: type[Message], array: ArraySchema, head: Mapping[str, Any] | None = None) -> bytes:
    """The schema of a message type.

    Args:
        cls: the type.
        array: says what becomes of its arrays; unit and meaning are added.
        head: properties that stand before its fields.
    """
    properties = {name: _field(name, spec, array) for name, spec in specs(cls).items()}
    schema = {
        "$schema": "https://json-schema.org/draft/2020-12/schema",
        "title": cls.__name__,
        "description": (cls.__doc__ or "").strip(),
        "type": "object",
        "properties": dict(head or {}) | properties,
    }
    return json.dumps(schema, indent=1).encode()


def _field(name: str, spec: FieldSpec, array: ArraySchema) -> dict[str, Any]:
    if spec.kind == "array":
        return array(name, spec) | _words(spec)
    entry: dict[str, Any] = {"type": "array", "items": {"type": "string"}}
    if spec.kind != "names":
        entry = {"type": _JSON_TYPE[spec.kind]}
    return entry | _words(spec)


def _array(_name: str, spec: FieldSpec) -> dict[str, Any]:
    raw: dict[str, Any] = {"type": "string", "contentEncoding": "binary"}
    facts = {"dtype": f"{spec.dtype}, little-endian", "shape": list(spec.shape)}
    if -1 in spec.shape:
        shape = {"type": "array", "items": {"type": "integer"}}
        return {"type": "array", "prefixItems": [shape, raw], "items": False} | facts
    return raw | facts


def _words(spec: FieldSpec) -> dict[str, str]:
    words = {"description": spec.doc, "unit": spec.unit}
    return {name: text for name, text in words.items() if text}
