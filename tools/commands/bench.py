"""`surefoot bench`: the hot paths on this machine."""

from __future__ import annotations

import argparse


def add(commands: argparse._SubParsersAction) -> None:
    """Add the command to the parser."""
    parser = commands.add_parser("bench", help="measure the hot paths on this machine")
    parser.set_defaults(run=_run)


def _run(call: argparse.Namespace) -> int:
    from surefoot.tools.bench import bench

    bench()
    return 0
