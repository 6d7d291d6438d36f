"""The settings of a run that are not what they are when nothing is said."""

from __future__ import annotations

from collections.abc import Iterator
from typing import Any

from surefoot.config.deployment import Deployment
from surefoot.config.typed_toml import to_table


def own_settings(config: dict[str, Any]) -> list[tuple[str, str, str]]:
    """(dotted path, value, default) of every setting that differs from its default, or that is not known here."""
    return list(_different(config, to_table(Deployment()), ""))


def _different(config: dict[str, Any], default: dict[str, Any], path: str) -> Iterator[tuple[str, str, str]]:
    for key, value in config.items():
        where = f"{path}{key}"
        usual = default.get(key)
        if isinstance(value, dict) and isinstance(usual, dict):
            yield from _different(value, usual, f"{where}.")
        elif value != usual:
            yield where, _shown(value), "–" if key not in default else _shown(usual)


def _shown(value: Any) -> str:
    return "none" if value is None else str(value)
