"""`surefoot command`: tell the robot what to do."""

from __future__ import annotations

import argparse

from surefoot.tools.commands.bus_call import add_bus_arguments
from surefoot.tools.commands.call import CallError
from surefoot.tools.commands.say import say_on_bus


def add(commands: argparse._SubParsersAction) -> None:
    """Add the command to the parser."""
    parser = commands.add_parser("command", help="command the robot of a running stack")
    parser.add_argument(
        "command", help="hold, stand, sit, forward, backward, left, right, stop (the walk, and stand), damp or cut"
    )
    add_bus_arguments(parser)
    parser.set_defaults(run=_run)


def _run(call: argparse.Namespace) -> int:
    from surefoot.components.clock_messages import REQUEST
    from surefoot.components.fsm.fsm import COMMANDS

    if call.command not in COMMANDS:
        raise CallError(f"unknown command {call.command!r}; there are {', '.join(COMMANDS)}")
    say_on_bus(call, REQUEST, call.command)
    return 0
