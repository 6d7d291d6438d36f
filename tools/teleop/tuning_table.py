"""The settings of a run that can be tuned, for a person and for a script."""

from __future__ import annotations

from typing import Any

from rich.table import Table

from surefoot.config.tuning import shown, tunable_settings, value_of
from surefoot.config.typed_toml import to_table
from surefoot.tools.teleop.tuned_run import TunedRun


def tuning_rows(run: TunedRun) -> list[dict[str, Any]]:
    """Of each setting its key, value, the value that the run began with, limits, and whether it was changed."""
    rows = []
    for key, setting in tunable_settings().items():
        now, begun, limits = value_of(run.now, key), value_of(run.begun, key), setting.limits
        rows.append(
            {
                "key": key,
                "value": to_table(now),
                "begun": to_table(begun),
                "least": None if limits is None else limits.least,
                "most": None if limits is None else limits.most,
                "changed": now != begun,
            }
        )
    return rows


def tuning_table(rows: list[dict[str, Any]]) -> Table:
    """For a terminal; what was changed stands out."""
    table = Table(box=None, padding=(0, 2, 0, 0), header_style="dim")
    for column in ("setting", "value", "allowed", "the run began with"):
        table.add_column(column, no_wrap=True)
    for row in rows:
        allowed = tunable_settings()[row["key"]].allowed
        begun = shown(_tuple(row["begun"])) if row["changed"] else ""
        style = "bold cyan" if row["changed"] else ""
        table.add_row(row["key"], shown(_tuple(row["value"])), allowed, begun, style=style)
    return table


def _tuple(value: Any) -> Any:
    return tuple(value) if isinstance(value, list) else value
