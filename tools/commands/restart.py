"""`surefoot restart`: one process of a running stack."""

from __future__ import annotations

import argparse

from surefoot.tools.commands.call import CallError
from surefoot.tools.commands.say import say_on_bus


def add(commands: argparse._SubParsersAction) -> None:
    """Add the command to the parser."""
    parser = commands.add_parser("restart", help="restart one process of a running stack")
    parser.add_argument("name")
    parser.add_argument("--namespace", default="surefoot")
    parser.set_defaults(run=_run)


def _run(call: argparse.Namespace) -> int:
    from surefoot.bus.topics import PROCESSES
    from surefoot.tools.supervisor_messages import REQUEST

    if call.name not in PROCESSES or call.name == "io":
        names = ", ".join(name for name in PROCESSES if name != "io")
        raise CallError(f"cannot restart {call.name!r}; processes that can be: {names} (io holds robot and bus)")
    say_on_bus(call.namespace, REQUEST, f"restart {call.name}")
    return 0
