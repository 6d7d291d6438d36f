"""`surefoot emulated`: the stack and an emulated robot together, in simulated time."""

from __future__ import annotations

import argparse

from surefoot.tools.commands.call import deployment_file

_EMULATED = """\
Run the whole stack in one process, in simulated time, with an emulated Aliengo over UDP: the packets are the
real robot's, and what the link does to them is set under `emulator`. The robot gets up from the ground and goes.
What is said of it at the end is the emulator's truth, not the stack's opinion.

exit code: 0 the goal was reached, or the time was up, and the robot has stood and never fallen; 1 it has fallen,
was lost or never stood; 2 the call was wrong
"""


def add(commands: argparse._SubParsersAction) -> None:
    """Add the command to the parser."""
    parser = commands.add_parser(
        "emulated",
        help="the stack with an emulated Aliengo, graded",
        formatter_class=argparse.RawDescriptionHelpFormatter,
        description=_EMULATED,
        epilog="example: surefoot emulated planks_emulated --for 10 --set emulator.commands.loss=0.05",
    )
    parser.add_argument(
        "config", nargs="?", default="planks_emulated", help="a deployment file, or its name in config/"
    )
    parser.add_argument("--set", action="append", default=[], metavar="KEY=VALUE", help="override a setting")
    parser.add_argument(
        "--for", dest="seconds", type=float, default=1200.0, help="end after this much simulated time [s]"
    )
    parser.set_defaults(run=_run)


def _run(call: argparse.Namespace) -> int:
    from surefoot.config.deployment import load_deployment
    from surefoot.tools.emulated_walk import walk

    deployment = load_deployment(deployment_file(call.config), call.set)
    done = walk(deployment, call.seconds, lambda words: print(words, flush=True))
    print(done)
    return 0 if done.sound else 1
