"""A deployment as the text of its file: what differs from the defaults, and nothing else."""

from __future__ import annotations

import dataclasses
import json
from collections.abc import Iterator, Mapping
from typing import Any

from surefoot.config.deployment import Deployment
from surefoot.config.typed_toml import to_table

_OF_ONE_RUN = ("run.epoch_s",)


def deployment_text(deployment: Deployment, remarks: Mapping[str, str]) -> str:
    """TOML from which `load_deployment` makes an equal deployment.

    Args:
        deployment: as it is to be.
        remarks: by a setting's dotted path, what is to stand beside it.
    """
    lines = list(_section("", deployment, Deployment(), remarks))
    return "\n".join(lines).strip() + "\n"


def _section(path: str, part: Any, default: Any, remarks: Mapping[str, str]) -> Iterator[str]:
    """The table of a part, then those within it; nothing where all is as by default."""
    own, inner = [], []
    for field in dataclasses.fields(part):
        value, usual = getattr(part, field.name), getattr(default, field.name)
        where = f"{path}.{field.name}".lstrip(".")
        if where in _OF_ONE_RUN or (value == usual and where not in remarks):
            continue
        if dataclasses.is_dataclass(value) and type(value) is type(usual):
            inner.append((where, value, usual))
        elif value is not None:
            remark = f"  # {remarks[where]}" if where in remarks else ""
            own.append(f"{field.name} = {_value(to_table(value))}{remark}")
    if own:
        yield from ["", f"[{path}]"] if path else []
        yield from own
    for each in inner:
        yield from _section(*each, remarks)


def _value(value: Any) -> str:
    if isinstance(value, bool):
        return str(value).lower()
    if isinstance(value, str):
        return json.dumps(value, ensure_ascii=False)
    if isinstance(value, list):
        return f"[{', '.join(map(_value, value))}]"
    if isinstance(value, dict):
        pairs = (f"{key} = {_value(item)}" for key, item in value.items() if item is not None)
        return f"{{{', '.join(pairs)}}}"
    return repr(value)
