"""`surefoot command`: tell the robot what to do."""

from __future__ import annotations

import argparse

from surefoot.components.fsm.words import COMMANDS, MEANINGS, NoCommand, read_command
from surefoot.tools.commands.bus_call import add_bus_arguments, open_bus
from surefoot.tools.commands.call import CallError
from surefoot.tools.commands.say import say_command

_EPILOG = """\
exit code: 0 the robot obeys, now or when the step is over; 1 refused, or not answered; 2 the call was wrong

examples: surefoot command direction 0.7 -0.7
          surefoot command pause && surefoot command step
"""


def add(commands: argparse._SubParsersAction) -> None:
    """Add the command to the parser."""
    words = "\n".join(f"{word:<10} {meaning}" for word, meaning in MEANINGS.items())
    parser = commands.add_parser(
        "command",
        help="command the robot of a running stack",
        formatter_class=argparse.RawDescriptionHelpFormatter,
        description=f"Say one command, and print what the state machine answers.\n\n{words}",
        epilog=_EPILOG,
    )
    parser.add_argument("command", nargs="+", metavar="WORD", help=", ".join(COMMANDS))
    add_bus_arguments(parser)
    parser.set_defaults(run=_run)


def _run(call: argparse.Namespace) -> int:
    from surefoot.tools.teleop.remote import Remote

    words = " ".join(call.command)
    try:
        read_command(words)
    except NoCommand as error:
        raise CallError(str(error)) from None
    session = open_bus(call)
    try:
        return say_command(Remote(session, beats=False), session.where, words)
    finally:
        session.close()
