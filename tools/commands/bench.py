"""`surefoot bench`: the hot paths on this machine."""

from __future__ import annotations

import argparse

_BENCH = """\
Time every part of a tick of each controller, the bus, the recorder and the robot's driver on this machine, beside
a workload that is the same everywhere. It takes some minutes, and means something on a machine that does nothing
else.

exit code: 0 measured; 2 the call was wrong
"""


def add(commands: argparse._SubParsersAction) -> None:
    """Add the command to the parser."""
    parser = commands.add_parser(
        "bench",
        help="measure the hot paths on this machine",
        formatter_class=argparse.RawDescriptionHelpFormatter,
        description=_BENCH,
        epilog="example: surefoot bench",
    )
    parser.set_defaults(run=_run)


def _run(call: argparse.Namespace) -> int:
    from surefoot.tools.bench import bench

    bench()
    return 0
