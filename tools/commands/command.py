"""`surefoot command`: tell the robot what to do."""

from __future__ import annotations

import argparse

from surefoot.tools.commands.bus_call import add_bus_arguments
from surefoot.tools.commands.call import CallError
from surefoot.tools.commands.say import say_on_bus

_COMMAND = """\
Say a word to the robot of a running stack. What becomes of it is shown by `surefoot status`: a word that cannot be
obeyed now is refused there, with the reason.

exit code: 0 it was said; 2 the call was wrong, or no stack runs there
"""


def add(commands: argparse._SubParsersAction) -> None:
    """Add the command to the parser."""
    parser = commands.add_parser(
        "command",
        help="command the robot of a running stack",
        formatter_class=argparse.RawDescriptionHelpFormatter,
        description=_COMMAND,
        epilog="examples: surefoot command stand\n          surefoot command forward",
    )
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
