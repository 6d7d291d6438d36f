"""Which class is behind each process's name; classes are imported when asked for."""

from __future__ import annotations

from importlib import import_module

from surefoot.bus.topics import PROCESSES
from surefoot.components.component import Component


def component_class(name: str) -> type[Component]:
    """The component of a process.

    The class of process `elevation_map` is `ElevationMap` in `surefoot.components.elevation_map.elevation_map`.

    Raises:
        KeyError: no such process; the message lists those that are.
    """
    if name not in PROCESSES:
        raise KeyError(f"no process {name!r}; there are {', '.join(PROCESSES)}")
    module = import_module(f"surefoot.components.{name}.{name}")
    return getattr(module, "".join(part.capitalize() for part in name.split("_")))
