"""The JSON schema of a message type, for readers of recordings that do not have this program."""

from __future__ import annotations

import json
from collections.abc import Callable
from typing import Any

from surefoot.bus.message import FieldSpec, Message, specs

_JSON_TYPE = {"number": "number", "integer": "integer", "flag": "boolean", "text": "string"}


def json_schema(cls: type[Message]) -> bytes:
    """The schema of the msgpack map that `bus.codec` makes of a message.

    An array is a byte string: `dtype` says how to read it, `shape` how to fold it (-1: any length; then the
    field is a list of the real shape and the bytes).
    """
    properties: dict[str, Any] = {"message": {"const": cls.__name__}}
    return _schema(cls, properties | {name: _field(spec, _array) for name, spec in specs(cls).items()})


def plain_json_schema(cls: type[Message]) -> bytes:
    """The schema of a message as plain JSON, its arrays as lists of lists."""
    return _schema(cls, {name: _field(spec, _lists) for name, spec in specs(cls).items()})


def _schema(cls: type[Message], properties: dict[str, Any]) -> bytes:
    schema = {
        "$schema": "https://json-schema.org/draft/2020-12/schema",
        "title": cls.__name__,
        "description": (cls.__doc__ or "").strip(),
        "type": "object",
        "properties": properties,
    }
    return json.dumps(schema, indent=1).encode()


def _field(spec: FieldSpec, array: Callable[[FieldSpec], dict[str, Any]]) -> dict[str, Any]:
    if spec.kind == "array":
        return array(spec)
    entry: dict[str, Any] = {"type": "array", "items": {"type": "string"}}
    if spec.kind != "names":
        entry = {"type": _JSON_TYPE[spec.kind]}
    return entry | _words(spec)


def _array(spec: FieldSpec) -> dict[str, Any]:
    raw: dict[str, Any] = {"type": "string", "contentEncoding": "binary"}
    facts = {"dtype": f"{spec.dtype}, little-endian", "shape": list(spec.shape)} | _words(spec)
    if -1 in spec.shape:
        shape = {"type": "array", "items": {"type": "integer"}}
        return {"type": "array", "prefixItems": [shape, raw], "items": False} | facts
    return raw | facts


def _lists(spec: FieldSpec) -> dict[str, Any]:
    of = {"bool": "boolean", "int64": "integer", "uint8": "integer"}.get(spec.dtype, "number")
    entry: dict[str, Any] = {"type": of}
    for length in reversed(spec.shape):
        entry = {"type": "array", "items": entry}
        if length >= 0:
            entry |= {"minItems": length, "maxItems": length}
    return entry | _words(spec)


def _words(spec: FieldSpec) -> dict[str, str]:
    words = {"description": spec.doc, "unit": spec.unit}
    return {name: text for name, text in words.items() if text}
