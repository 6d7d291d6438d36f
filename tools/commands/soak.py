"""`surefoot soak`: a long run of the emulated robot whose memory and files are watched."""

from __future__ import annotations

import argparse
from pathlib import Path

from surefoot.tools.commands.call import deployment_file

_SOAK = """\
Start an emulator and a run with it, and note memory and open files of every process until the run's time is up. At
the end each process is told with both, in the second quarter of the run and in the last; more than 8 MB or one
file more is growth. The robot should never arrive: give it flat ground and no goal, as in the example.

exit code: 0 the run went well and nothing grew; 1 it did not, or something did; 2 the call was wrong
"""


def add(commands: argparse._SubParsersAction) -> None:
    """Add the command to the parser."""
    parser = commands.add_parser(
        "soak",
        help="a long run of the emulated robot: does anything grow?",
        formatter_class=argparse.RawDescriptionHelpFormatter,
        description=_SOAK,
        epilog="example: surefoot soak --set terrain.kind=flat --set fsm.goal_m=0 --for 3600 --out soak",
    )
    parser.add_argument(
        "config", nargs="?", default="planks_emulated", help="a deployment file, or its name in config/"
    )
    parser.add_argument("--set", action="append", default=[], metavar="KEY=VALUE", help="override a setting")
    parser.add_argument("--for", dest="seconds", type=float, default=3600.0, help="of the run's time [s]")
    parser.add_argument("--every", type=float, default=10.0, help="between samples, of wall time [s]")
    parser.add_argument("--out", type=Path, required=True, help="folder for samples.csv and the logs")
    parser.set_defaults(run=_run)


def _run(call: argparse.Namespace) -> int:
    from surefoot.config.deployment import load_deployment
    from surefoot.tools.soak import soak

    config = deployment_file(call.config)
    load_deployment(config, call.set)  # a wrong call is told here, not in a log
    code, found = soak(config, call.set, call.seconds, call.every, call.out, print)
    print("\n".join(map(str, found)))
    print(f"the run ended with {code}; see {call.out}/run.txt")
    return 0 if code == 0 and all(each.flat for each in found) else 1
