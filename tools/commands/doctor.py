"""`surefoot doctor`: everything that can be checked without motion."""

from __future__ import annotations

import argparse

from surefoot.tools.commands.call import deployment_file

_DOCTOR = """\
Check a robot, the way to it and this machine, without motion. A line for each check: ok, warn, fail, or n/a where
it does not apply to the deployment; what was found and, where that is not well, what was expected and what to do.

The robot is sent zero gains until it answers and then damping for a second: hang it up or let it lie. While a run
of the same namespace is up nothing is sent.

exit code: 0 nothing failed; 1 something did; 2 the call was wrong
"""


def add(commands: argparse._SubParsersAction) -> None:
    """Add the command to the parser."""
    parser = commands.add_parser(
        "doctor",
        help="check robot, network and machine without motion",
        formatter_class=argparse.RawDescriptionHelpFormatter,
        description=_DOCTOR,
        epilog="example: surefoot doctor aliengo --json | jq .ok",
    )
    parser.add_argument("config", nargs="?", default="aliengo", help="a deployment file, or its name in config/")
    parser.add_argument("--set", action="append", default=[], metavar="KEY=VALUE", help="override a setting")
    parser.add_argument("--host", metavar="NAME", help="this machine's name in network.hosts; default: that of io")
    parser.add_argument("--json", action="store_true", help="for a script")
    parser.set_defaults(run=_run)


def _run(call: argparse.Namespace) -> int:
    from rich.console import Console

    from surefoot.config.deployment import load_deployment
    from surefoot.tools.doctor.check import failures
    from surefoot.tools.doctor.examination import examine
    from surefoot.tools.doctor.report import as_json, as_lines

    overrides = [*call.set, f"network.host={call.host}"] if call.host else call.set
    deployment = load_deployment(deployment_file(call.config), overrides)
    console = Console(soft_wrap=True, highlight=False, stderr=call.json)
    findings = examine(deployment, console.print)
    if call.json:
        print(as_json(findings))
    else:
        console.print(*as_lines(findings), sep="\n")
    return 1 if failures(findings) else 0
