"""What people run: evaluation, plots and the command line. Imports everything; nobody imports it.

`load` reads a recording into tables of NumPy arrays; it is imported when it is asked for.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from surefoot.tools.tables.recording_tables import load as load


def __getattr__(name: str) -> Any:
    if name == "load":
        from surefoot.tools.tables.recording_tables import load

        return load
    raise AttributeError(f"module {__name__!r} has no attribute {name!r}")
