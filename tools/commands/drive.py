"""`surefoot drive`: the robot at the keys of a terminal, or at a gamepad through the browser."""

from __future__ import annotations

import argparse
import sys

from surefoot.tools.commands.bus_call import add_bus_arguments, open_bus
from surefoot.tools.commands.call import CallError

PORT = 8081

_DRIVE = """\
Drive the robot of a running stack with the keys of this terminal, also over ssh. One screen shows what the state
machine is at, the leg with its candidate, the force asked and held, how far the foot has moved, and what was
answered to each command; where a leg has found no foothold, what became of each candidate.

arrows, wasd   walk in a direction, after the step       space   halt after the step
p              pause after the step, and resume          n       one step, then pause
k              skip this foothold                        r       press again
u, j           stand up, sit down                        S       stop at once: the leg goes back
X, then y      cut: no torque, the robot falls           q       leave

With --browser a page on this machine does the same by a gamepad, by the same keys and by buttons to touch. The
left stick walks where it points and halts when it is let go; L1 held, then Select cuts; the page shows the rest.
From another machine: ssh -L 8081:127.0.0.1:8081 ROBOT

Where operator.heartbeat_s asks for one, this terminal is the operator's heartbeat, or the page as long as it is in
sight: a robot whose driver leaves, or whose link is lost, sits down.

exit code: 0 left by the person; 1 the stack has ended; 2 no stack runs there, this is no terminal, or the port is
taken
"""


def add(commands: argparse._SubParsersAction) -> None:
    """Add the command to the parser."""
    parser = commands.add_parser(
        "drive",
        help="drive the robot with the keys of this terminal, or with a gamepad",
        formatter_class=argparse.RawDescriptionHelpFormatter,
        description=_DRIVE,
        epilog="examples: surefoot drive --connect mine.toml\n          surefoot drive --browser",
    )
    parser.add_argument("--browser", action="store_true", help="serve a page for a gamepad, keys and touch")
    parser.add_argument("--port", type=int, help=f"of the page; 0 any that is free; default {PORT}")
    add_bus_arguments(parser)
    parser.set_defaults(run=_run)


def _run(call: argparse.Namespace) -> int:
    if call.browser:
        return _serve_page(call)
    if call.port is not None:
        raise CallError("--port is of the page: say --browser as well")
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


def _serve_page(call: argparse.Namespace) -> int:
    try:
        from surefoot.tools.teleop.drive_page import DrivePage
    except ModuleNotFoundError as error:
        raise CallError(f"the page needs the package {error.name}: pip install 'surefoot[view]'") from None
    import signal

    from surefoot.components.process_end import ProcessEnd

    signal.signal(signal.SIGTSTP, signal.SIG_IGN)  # a robot whose driver sleeps hears no stop
    end = ProcessEnd()
    signal.signal(signal.SIGHUP, signal.getsignal(signal.SIGTERM))
    page = DrivePage(lambda: open_bus(call), PORT if call.port is None else call.port)
    print(f"drive: {page.url}; Ctrl-C ends it", flush=True)
    try:
        page.run(lambda: end.due)
    finally:
        page.close()
    if page.ended:
        print(f"the stack has ended: {page.ended}")
    return 1 if page.ended else 0
