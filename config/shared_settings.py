"""What all processes of a run must have alike: the resolved deployment, without what is each machine's own."""

from __future__ import annotations

import hashlib
import json
from typing import Any

from surefoot.config.deployment import Deployment
from surefoot.config.typed_toml import to_table

_OWN = {
    "run": ("command", "epoch_s", "log_dir", "solve_share_max", "cores_min", "realtime_priority"),
    "hw": ("unit",),
    "network": ("host", "listen", "address", "keys_dir", "insecure"),
}
"""Keys of each section that only the machine itself goes by."""

_WHOLLY_OWN = ("doctor",)
"""Sections that are no process's."""

_DIGEST = 8  # hexadecimal digits: by chance two are alike once in four billion


def shared_settings(tables: dict[str, Any]) -> dict[str, Any]:
    """Settings by dotted path, of a deployment given as tables.

    On the monotonic clock those of `mpc` are left out: the machine that solves chooses its profile, and nobody
    else reads them.
    """
    tables = {section: table for section, table in tables.items() if section not in _chosen_here(tables)}
    found: dict[str, Any] = {}
    for section, table in tables.items():
        if isinstance(table, dict):
            table = {key: value for key, value in table.items() if key not in _OWN.get(section, ())}
        _flatten(section, table, found)
    return found


def settings_digest(deployment: Deployment) -> str:
    """A short word that two deployments share when their shared settings are equal."""
    packed = json.dumps(shared_settings(to_table(deployment)), sort_keys=True)
    return hashlib.sha256(packed.encode()).hexdigest()[:_DIGEST]


def differences(mine: dict[str, Any], other: dict[str, Any]) -> list[str]:
    """Where two deployments, given as tables, do not go together, in words: the key, this value, that one."""
    left, right = shared_settings(mine), shared_settings(other)
    return [
        f"{key} = {_shown(left, key)}, not {_shown(right, key)}"
        for key in sorted(left.keys() | right.keys())
        if (key in left, left.get(key)) != (key in right, right.get(key))
    ]


def _chosen_here(tables: dict[str, Any]) -> tuple[str, ...]:
    chosen = ("mpc",) if tables.get("run", {}).get("clock") == "monotonic" else ()
    return (*_WHOLLY_OWN, *chosen)


def _flatten(path: str, value: Any, into: dict[str, Any]) -> None:
    if isinstance(value, dict):
        for key, item in value.items():
            _flatten(f"{path}.{key}", item, into)
    else:
        into[path] = value


def _shown(settings: dict[str, Any], key: str) -> str:
    return repr(settings[key]) if key in settings else "known"
