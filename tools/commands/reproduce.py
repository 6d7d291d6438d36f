"""`surefoot reproduce`: the paper's experiments on one page."""

from __future__ import annotations

import argparse
from pathlib import Path

from surefoot.tools.commands.call import seeds

_REPRODUCE = """\
Run the experiments of the paper's Figs. 8 to 12 and write one page with its figures, its words and the data. A run
is made once: stopped with Ctrl-C, the same call goes on where it was.

exit code: 0 written; 2 the call was wrong; 130 stopped with Ctrl-C
"""


def add(commands: argparse._SubParsersAction) -> None:
    """Add the command to the parser."""
    parser = commands.add_parser(
        "reproduce",
        help="run the paper's experiments and write one page with its figures",
        formatter_class=argparse.RawDescriptionHelpFormatter,
        description=_REPRODUCE,
        epilog="example: surefoot reproduce out --quick",
    )
    parser.add_argument("out", type=Path, help="folder for index.html, the figures and the data")
    parser.add_argument("--quick", action="store_true", help="a short version, in minutes")
    parser.add_argument("--jobs", type=int, default=1, help="runs at the same time")
    parser.add_argument("--seeds", default="", help="of every experiment; without it, each one's own")
    parser.add_argument(
        "--set", action="append", default=[], metavar="KEY=VALUE", help="of config/reproduce.py: flat_goal_m=0.6"
    )
    parser.set_defaults(run=_run)


def _run(call: argparse.Namespace) -> int:
    import shlex

    from rich.console import Console

    from surefoot.config.reproduce import Reproduce
    from surefoot.config.typed_toml import build, with_override
    from surefoot.tools.reproduce.experiment import Plan
    from surefoot.tools.reproduce.reproduce import reproduce

    table: dict = {}
    for assignment in call.set:
        table = with_override(table, assignment)
    chosen = tuple(seeds(call.seeds)) if call.seeds else ()
    console = Console(soft_wrap=True, highlight=False)
    words = ["surefoot", "reproduce", str(call.out), *(["--quick"] if call.quick else [])]
    words += [
        *(["--seeds", call.seeds] if call.seeds else []),
        *(word for each in call.set for word in ("--set", each)),
    ]

    def say(line: str) -> None:
        console.print(line, markup=False)

    plan = Plan(build(Reproduce, table), chosen, call.quick)
    try:
        reproduce(call.out, plan, call.jobs, say, shlex.join(words))
    except KeyboardInterrupt:
        say("stopped; the same call goes on from here")
        raise
    return 0
