"""`surefoot heartbeat`: this machine says that the operator is there."""

from __future__ import annotations

import argparse
import time

from surefoot.tools.commands.bus_call import add_bus_arguments, open_bus
from surefoot.tools.commands.call import CallError

_HEARTBEAT = """\
Say again and again, until Ctrl-C, that the operator's machine is there. Where a deployment asks for it with
operator.heartbeat_s, a robot that hears nothing for so long settles as by `surefoot stop`, and obeys no command
to move until it hears the beat again and a person commands. Let it run on the machine that the robot is commanded
from: it watches the link to that machine, and not whether anybody sits before it.

exit code: 2 the call was wrong, no stack runs there or it asks for no heartbeat; 130 ended with Ctrl-C
"""


def add(commands: argparse._SubParsersAction) -> None:
    """Add the command to the parser."""
    parser = commands.add_parser(
        "heartbeat",
        help="say that the operator is there, until Ctrl-C",
        formatter_class=argparse.RawDescriptionHelpFormatter,
        description=_HEARTBEAT,
        epilog="example: surefoot heartbeat --connect mine.toml",
    )
    add_bus_arguments(parser)
    parser.set_defaults(run=_run)


def _run(call: argparse.Namespace) -> int:
    from surefoot.bus.service_keys import BEAT
    from surefoot.components.deployment_desk import ask_deployment
    from surefoot.config.operator import Operator
    from surefoot.config.typed_toml import build

    session = open_bus(call)
    try:
        settings = build(Operator, ask_deployment(session).get("operator", {}), "operator")
        if not settings.heartbeat_s:
            raise CallError("operator.heartbeat_s = 0: this run asks for no heartbeat")
        print(
            f"beating at {session.where}; without it the robot settles after {settings.heartbeat_s:g} s; "
            "Ctrl-C ends it",
            flush=True,
        )
        while True:
            session.put(BEAT, b"", lossless=False)
            time.sleep(settings.beat_s)
    finally:
        session.close()
