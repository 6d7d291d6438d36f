"""`surefoot drive`: the robot at the keys of a terminal."""

from __future__ import annotations

import argparse
import sys

from surefoot.tools.commands.bus_call import add_bus_arguments, open_bus
from surefoot.tools.commands.call import CallError

_DRIVE = """\
Drive the robot of a running stack with the keys of this terminal, also over ssh. One screen shows what the state
machine is at, the leg with its candidate, the force asked and held, how far the foot has moved, and what was
answered to each command; where a leg has found no foothold, what became of each candidate.

arrows, wasd   walk in a direction, after the step       space   halt after the step
p              pause after the step, and resume          n       one step, then pause
k              skip this foothold                        r       press again
u, j           stand up, sit down                        S       stop at once: the leg goes back
X, then y      cut: no torque, the robot falls           q       leave

Where operator.heartbeat_s asks for one, this terminal is the operator's heartbeat: a robot whose driver leaves,
or whose link is lost, sits down.

exit code: 0 left by the person; 1 the stack has ended; 2 no stack runs there, or this is no terminal
"""


def add(commands: argparse._SubParsersAction) -> None:
    """Add the command to the parser."""
    parser = commands.add_parser(
        "drive",
        help="drive the robot with the keys of this terminal",
        formatter_class=argparse.RawDescriptionHelpFormatter,
        description=_DRIVE,
        epilog="examples: surefoot drive\n          surefoot drive --connect mine.toml",
    )
    add_bus_arguments(parser)
    parser.set_defaults(run=_run)


def _run(call: argparse.Namespace) -> int:
    if not (sys.stdin.isatty() and sys.stdout.isatty()):
        raise CallError(
            "drive reads keys from a terminal, and this is none; start it in one (ssh -t), or say single words "
            "with surefoot command"
        )
    from rich.console import Console

    from surefoot.tools.teleop.driver import drive

    console = Console()
    ended = drive(lambda: open_bus(call), sys.stdin.fileno(), console)
    if ended:
        console.print(f"the stack has ended: {ended}", markup=False)
    return 1 if ended else 0
