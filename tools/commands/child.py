"""`surefoot child`: one process of a deployment."""

from __future__ import annotations

import argparse

from surefoot.tools.commands.call import CallError, deployment_file

_CHILD = """\
Run one process of a deployment here, in the foreground.

While `surefoot run` goes on in another terminal with the same namespace, its supervisor ends its own process of
that name and leaves this one alone: it has the run's settings, those given here on top, and the run's time.
Prints, `breakpoint()` and a debugger work; with the simulated clock time waits for you. When this process ends, by
Ctrl-C or otherwise, the supervisor starts its own again. io is not lent: it holds the robot and the bus. With the
monotonic clock estimator, wbc and fsm are lent only while the robot is damped.

Without a supervisor it joins whatever processes were started by hand in the same way, io first.

exit code: 0 it ended in order; 1 it failed, or had to be ended; 2 the call was wrong
"""

_EXAMPLES = """\
examples: surefoot child planks wbc
          python -P -m pdb -m surefoot.tools.cli child planks wbc
"""


def add(commands: argparse._SubParsersAction) -> None:
    """Add the command to the parser."""
    parser = commands.add_parser(
        "child",
        help="run one process of a deployment in the foreground, under a debugger if you like",
        formatter_class=argparse.RawDescriptionHelpFormatter,
        description=_CHILD,
        epilog=_EXAMPLES,
    )
    parser.add_argument("config", help="a deployment file, or its name in config/; that of the run")
    parser.add_argument("name", help="io, estimator, wbc, mpc, fsm, trajopt or elevation_map")
    parser.add_argument("--set", action="append", default=[], metavar="KEY=VALUE", help="override a setting")
    parser.add_argument("--namespace", default="", help="that of the run; the deployment's if left out")
    parser.add_argument("--boot", type=int, default=0, help="how often this process has been restarted")
    parser.add_argument("--parent", type=int, default=0, help="process id that must live on; 0 the caller's")
    parser.add_argument(
        "--relieve", action="store_true", help="take over from the running process (monotonic clock only)"
    )
    parser.set_defaults(run=_run)


def _run(call: argparse.Namespace) -> int:
    from surefoot.bus.topics import PROCESSES
    from surefoot.config.deployment import load_deployment
    from surefoot.tools.borrowed_process import run_borrowed, supervised_run

    file, settings = deployment_file(call.config), list(call.set)
    if call.namespace:
        settings.append(f"run.namespace={call.namespace}")
    deployment = load_deployment(file, settings)
    if call.name not in PROCESSES:
        raise CallError(f"no process {call.name!r}; there are {', '.join(PROCESSES)}")
    namespace = deployment.run.namespace
    run = None if call.parent else supervised_run(namespace)
    if run is None:
        return _work(deployment, call.name, call.boot, call.parent, call.relieve)
    if run.config != str(file.resolve()):
        raise CallError(
            f"the run with namespace {namespace!r} is of {run.config}: `surefoot child {run.config} {call.name}`"
        )
    deployment = load_deployment(file, [*run.settings, *settings])
    return run_borrowed(namespace, call.name, run, lambda boot: _work(deployment, call.name, boot, 0))


def _work(deployment, name: str, boot: int, parent: int, relieve: bool = False) -> int:
    from surefoot.components.clock_master import ClockMaster
    from surefoot.components.runner import HubRunner, Runner

    if name != "io":
        return Runner(deployment, name, boot, parent, relieve).run()
    if deployment.run.clock == "simulated":
        return ClockMaster(deployment, boot, parent).run()
    return HubRunner(deployment, "io", boot, parent).run()
