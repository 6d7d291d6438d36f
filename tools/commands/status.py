"""`surefoot status`: the health of a running stack."""

from __future__ import annotations

import argparse

_LISTEN_S = 1.5


def add(commands: argparse._SubParsersAction) -> None:
    """Add the command to the parser."""
    parser = commands.add_parser("status", help="health of a running stack, once")
    parser.add_argument("--namespace", default="surefoot")
    parser.set_defaults(run=_run)


def _run(call: argparse.Namespace) -> int:
    import time

    from rich.console import Console

    from surefoot.bus.codec import decode
    from surefoot.bus.messages import ProcessStatus
    from surefoot.bus.session import Session, socket_path
    from surefoot.tools.picture import Picture
    from surefoot.tools.status_screen import health, process_table

    session = Session(call.namespace, connect_ms=2000)
    picture = Picture()
    session.subscribe("status/*", lambda key, payload: picture.note_status(decode(ProcessStatus, payload)))
    time.sleep(_LISTEN_S)
    session.close()
    console = Console()
    console.print(f"connected to {socket_path(call.namespace)}", process_table(picture), health(picture), sep="\n")
    silent = [name for name, watched in picture.processes.items() if watched.status is None]
    if silent:
        print(f"silent for {_LISTEN_S} s: {', '.join(silent)}; are they running?")
    return 1 if silent else 0
