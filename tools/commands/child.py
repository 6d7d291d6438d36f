"""`surefoot child`: one process of a deployment."""

from __future__ import annotations

import argparse

from surefoot.tools.commands.call import CallError, deployment_file


def add(commands: argparse._SubParsersAction) -> None:
    """Add the command to the parser."""
    parser = commands.add_parser("child", help="run one process of a deployment in the foreground")
    parser.add_argument("config")
    parser.add_argument("name", help="io, estimator, wbc, mpc, fsm, trajopt or elevation_map")
    parser.add_argument("--set", action="append", default=[], metavar="KEY=VALUE")
    parser.add_argument("--boot", type=int, default=0, help="how often this process has been restarted")
    parser.add_argument("--parent", type=int, default=0, help="process id that must live on; 0 the caller's")
    parser.add_argument(
        "--relieve", action="store_true", help="take over from the running process (monotonic clock only)"
    )
    parser.set_defaults(run=_run)


def _run(call: argparse.Namespace) -> int:
    from surefoot.bus.topics import PROCESSES
    from surefoot.components.clock_master import ClockMaster
    from surefoot.components.runner import HubRunner, Runner
    from surefoot.config.deployment import load_deployment

    deployment = load_deployment(deployment_file(call.config), call.set)
    if call.name not in PROCESSES:
        raise CallError(f"no process {call.name!r}; there are {', '.join(PROCESSES)}")
    if call.name != "io":
        return Runner(deployment, call.name, call.boot, call.parent, call.relieve).run()
    if deployment.run.clock == "simulated":
        return ClockMaster(deployment, call.boot, call.parent).run()
    return HubRunner(deployment, "io", call.boot, call.parent).run()
