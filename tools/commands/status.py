"""`surefoot status`: the health of a running stack."""

from __future__ import annotations

import argparse

from surefoot.tools.commands.bus_call import add_bus_arguments, open_bus

_LISTEN_S = 1.5


def add(commands: argparse._SubParsersAction) -> None:
    """Add the command to the parser."""
    parser = commands.add_parser("status", help="health of a running stack, once")
    add_bus_arguments(parser)
    parser.set_defaults(run=_run)


def _run(call: argparse.Namespace) -> int:
    import time

    from rich.console import Console

    from surefoot.bus.codec import decode
    from surefoot.bus.messages import ProcessStatus
    from surefoot.tools.picture import Picture
    from surefoot.tools.status_screen import health, process_table

    session = open_bus(call)
    picture = Picture()
    session.subscribe("status/*", lambda key, payload: picture.note_status(decode(ProcessStatus, payload)))
    time.sleep(_LISTEN_S)
    session.close()
    console = Console()
    console.print(f"connected to {session.where}", process_table(picture), health(picture), sep="\n")
    silent = [name for name, watched in picture.processes.items() if watched.status is None]
    if silent:
        print(f"silent for {_LISTEN_S} s: {', '.join(silent)}; are they running?")
    return 1 if silent else 0
