"""`surefoot status`: the health of a running stack."""

from __future__ import annotations

import argparse

from surefoot.tools.commands.bus_call import add_bus_arguments, open_bus

_STATUS = """\
One screen of a running stack, until Ctrl-C or its end; without a terminal it is printed once.

Of each process: its state, its rate against nominal, the median, the 99th percentile and the longest of its last
2000 steps, missed deadlines (late), dropped messages (bad), the input that is oldest for what it may be with its
age and that limit, and how often it was restarted (boot). Below, in words, what is the matter with whom, what the
state machine and the supervisor did last, and why nothing moves.

exit code: 0 every process is well; 1 one is not, or the stack has ended; 2 no stack runs there
"""


def add(commands: argparse._SubParsersAction) -> None:
    """Add the command to the parser."""
    parser = commands.add_parser(
        "status",
        help="health of a running stack, and why nothing moves",
        formatter_class=argparse.RawDescriptionHelpFormatter,
        description=_STATUS,
        epilog="examples: surefoot status\n          surefoot status --json | jq -r .why",
    )
    add_bus_arguments(parser)
    parser.add_argument("--once", action="store_true", help="print it once")
    parser.add_argument("--json", action="store_true", help="once, for a script")
    parser.add_argument("--wait", action="store_true", help="wait for a stack, and for the next when it ends")
    parser.set_defaults(run=_run)


def _run(call: argparse.Namespace) -> int:
    from rich.console import Console

    from surefoot.tools.stack_watch import show_live, show_once

    console = Console(stderr=call.json)
    if call.once or call.json or not console.is_terminal:
        return show_once(lambda: open_bus(call), call.wait, call.json, console)
    return show_live(lambda: open_bus(call), call.wait, console)
