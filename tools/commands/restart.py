"""`surefoot restart`: one process of a running stack."""

from __future__ import annotations

import argparse

from surefoot.tools.commands.bus_call import add_bus_arguments
from surefoot.tools.commands.call import CallError
from surefoot.tools.commands.say import say_on_bus

_RESTART = """\
Start one process of a running stack again; it goes on where it stood. With the simulated clock at any time. On the
monotonic clock another process is made ready first and then takes its place, which for estimator, wbc and fsm
needs a robot that stands, has stopped or is damped. io cannot be restarted: it holds the robot and the bus.

exit code: 0 it was asked for; 2 the call was wrong, or no stack runs there
"""


def add(commands: argparse._SubParsersAction) -> None:
    """Add the command to the parser."""
    parser = commands.add_parser(
        "restart",
        help="restart one process of a running stack",
        formatter_class=argparse.RawDescriptionHelpFormatter,
        description=_RESTART,
        epilog="example: surefoot restart mpc",
    )
    parser.add_argument("name", help="estimator, wbc, mpc, fsm, trajopt or elevation_map")
    add_bus_arguments(parser)
    parser.set_defaults(run=_run)


def _run(call: argparse.Namespace) -> int:
    from surefoot.bus.service_keys import SUPERVISOR_REQUEST
    from surefoot.bus.topics import PROCESSES

    if call.name not in PROCESSES or call.name == "io":
        names = ", ".join(name for name in PROCESSES if name != "io")
        raise CallError(f"cannot restart {call.name!r}; processes that can be: {names} (io holds robot and bus)")
    say_on_bus(call, SUPERVISOR_REQUEST, f"restart {call.name}")
    return 0
