"""`surefoot stop`: the robot sits down and is damped."""

from __future__ import annotations

import argparse

from surefoot.tools.commands.bus_call import add_bus_arguments
from surefoot.tools.commands.say import say_at_once

_STOP = """\
Let the robot of a running stack settle, from whatever it does: a leg in the air is put down, the robot sits down
and is damped. The run stays up, and nothing moves before `surefoot command stand` or a direction. If it is still
driven after operator.settle_s, io damps it. `surefoot command stop` is something else: it ends a walk, and the
robot stands. `surefoot cut` takes the torque away at once. Ctrl-C in the terminal of `surefoot run` ends the run.

It is said at once; then the answer is waited for.

exit code: 0 the robot obeys; 1 refused, or not answered; 2 the call was wrong, or no stack runs there
"""


def add(commands: argparse._SubParsersAction) -> None:
    """Add the command to the parser."""
    parser = commands.add_parser(
        "stop",
        help="sit down, then damp; the run stays up",
        formatter_class=argparse.RawDescriptionHelpFormatter,
        description=_STOP,
        epilog="example: surefoot stop",
    )
    add_bus_arguments(parser)
    parser.set_defaults(run=_run)


def _run(call: argparse.Namespace) -> int:
    return say_at_once(call, "sit")
