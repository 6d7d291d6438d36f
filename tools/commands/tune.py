"""`surefoot tune`: change settings of a running stack."""

from __future__ import annotations

import argparse
import json
from pathlib import Path
from typing import TYPE_CHECKING

from surefoot.tools.commands.bus_call import add_bus_arguments, open_bus
from surefoot.tools.commands.call import CallError

if TYPE_CHECKING:
    from surefoot.bus.session import Session
    from surefoot.tools.teleop.tuned_run import TunedRun

_TUNE = """\
Change one setting of a running stack: a weight, a gain or a threshold that is marked as tunable. It is checked as
a deployment is, recorded, and taken over between two steps by every component that goes by it; a component that is
restarted later keeps it. What the safety gate goes by cannot be tuned.
"""
_EPILOG = """\
exit code: 0 done; 1 refused, or not answered; 2 the call was wrong, or no stack runs there

examples: surefoot tune ocp.weights.force 0.012
          surefoot tune wbc.wrench_weight '[1, 1, 2, 2, 2, 1]'
          surefoot tune --list --json | jq '.[] | select(.changed)'
          surefoot tune --save mine.toml
"""


def add(commands: argparse._SubParsersAction) -> None:
    """Add the command to the parser."""
    parser = commands.add_parser(
        "tune",
        help="change settings of a running stack, list them, save them",
        formatter_class=argparse.RawDescriptionHelpFormatter,
        description=_TUNE,
        epilog=_EPILOG,
    )
    parser.add_argument("key", nargs="?", metavar="KEY", help="such as wbc.kp")
    parser.add_argument("value", nargs="?", metavar="VALUE", help="a number, true or false, or a list in brackets")
    parser.add_argument("--list", action="store_true", help="what can be tuned, its limits, what was changed")
    parser.add_argument("--json", action="store_true", help="the list for a script")
    parser.add_argument("--save", metavar="FILE", type=Path, help="write a deployment with what was changed")
    add_bus_arguments(parser)
    parser.set_defaults(run=_run)


def _run(call: argparse.Namespace) -> int:
    _check(call)
    session = open_bus(call)
    try:
        if call.key is not None:
            return _change(session, call.key, call.value)
        from surefoot.tools.teleop.tuned_run import TunedRun

        run = TunedRun.of(session)
    finally:
        session.close()
    if call.save is not None:
        _save(run, call.save)
    else:
        _list(run, call.json)
    return 0


def _check(call: argparse.Namespace) -> None:
    wanted = [call.key is not None, call.list or call.json, call.save is not None]
    if sum(wanted) != 1 or (call.key is not None and call.value is None):
        raise CallError("tune: give KEY and VALUE, or --list, or --save FILE")
    if call.save is not None and call.save.exists():
        raise CallError(f"{call.save} is there already: give another name")


def _change(session: Session, key: str, value: str) -> int:
    from surefoot.tools.teleop.remote import Remote

    answer = Remote(session, beats=False).tune(key, value)
    print(answer.words if answer.taken else f"refused: {answer.words}")
    return 0 if answer.taken else 1


def _list(run: TunedRun, as_json: bool) -> None:
    from surefoot.tools.teleop.tuning_table import tuning_rows, tuning_table

    rows = tuning_rows(run)
    if as_json:
        print(json.dumps(rows, indent=2))
        return
    from rich.console import Console

    Console().print(tuning_table(rows))


def _save(run: TunedRun, path: Path) -> None:
    path.write_text(run.file_text())
    print(f"{path}: {len(run.changed)} settings changed in the run; surefoot run {path} begins with them")
