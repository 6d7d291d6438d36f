"""`surefoot cut`: no torque at once."""

from __future__ import annotations

import argparse

from surefoot.tools.commands.bus_call import add_bus_arguments
from surefoot.tools.commands.say import say_at_once

_CUT = """\
Take the torque from every joint of the robot of a running stack in the next cycle: it falls where it is. io
itself obeys; no other process has to run. Nothing moves before `surefoot command damp`, which brakes the joints
again, and then `stand`.

It is said at once; then the state machine's answer is waited for, without which io obeys all the same.

exit code: 0 the robot obeys; 1 refused, or not answered; 2 the call was wrong, or no stack runs there
"""


def add(commands: argparse._SubParsersAction) -> None:
    """Add the command to the parser."""
    parser = commands.add_parser(
        "cut",
        help="no torque at once: the robot falls",
        formatter_class=argparse.RawDescriptionHelpFormatter,
        description=_CUT,
        epilog="example: surefoot cut",
    )
    add_bus_arguments(parser)
    parser.set_defaults(run=_run)


def _run(call: argparse.Namespace) -> int:
    return say_at_once(call, "cut")
