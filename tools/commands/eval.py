"""`surefoot eval`: grade the stack."""

from __future__ import annotations

import argparse
import os
import sys
from collections.abc import Iterator
from contextlib import contextmanager, nullcontext, redirect_stdout
from pathlib import Path

from surefoot.tools.commands.call import deployment_file, seeds

_EVAL = """\
Run a deployment in lockstep, a run for each seed, and grade it with the simulator's truth. Both files in the
folder are written after every run; the same call goes on where it was stopped.

exit code: 0 every run succeeded; 1 one did not; 2 the call was wrong
"""


def add(commands: argparse._SubParsersAction) -> None:
    """Add the command to the parser."""
    parser = commands.add_parser(
        "eval",
        help="grade the stack in lockstep",
        formatter_class=argparse.RawDescriptionHelpFormatter,
        description=_EVAL,
        epilog="example: surefoot eval planks --seeds 0:10 --jobs 2 --out out",
    )
    parser.add_argument("scenario", help="a deployment file, or its name in config/ (flat, planks, rocks, ...)")
    parser.add_argument("--seeds", default="0:10", help="first:last+1, or a list such as 0,3,7")
    parser.add_argument(
        "--arm", default="full", help="full, mpc_only, true_state, ... or NAME=FIGURE; a wrong one lists all"
    )
    parser.add_argument("--vision", choices=("on", "off"), help="with or without the depth camera and its map")
    parser.add_argument("--set", action="append", default=[], metavar="KEY=VALUE", help="override a setting")
    parser.add_argument("--jobs", type=int, default=1, help="runs at the same time")
    parser.add_argument(
        "--dask",
        default="",
        metavar="ADDRESS",
        help="run on the workers of this Dask scheduler instead; they need surefoot[cluster] and the same files",
    )
    parser.add_argument("--limit", type=float, default=1200.0, help="simulated seconds that count as a time-out")
    parser.add_argument("--out", type=Path, required=True, help="folder for results.json and summary.md")
    parser.add_argument(
        "--fresh", action="store_true", help="do seeds again that the folder's results.json has already"
    )
    parser.add_argument(
        "--record", action="store_true", help="keep a recording of every run in the folder: about 5 MB a second"
    )
    parser.add_argument("--json", action="store_true", help="print the outcome and the marks for a script")
    parser.set_defaults(run=_run)


def _run(call: argparse.Namespace) -> int:
    import json

    from surefoot.tools.evaluation.evaluate import evaluate
    from surefoot.tools.evaluation.summary import outcome, summary

    with _progress_to_stderr() if call.json else nullcontext():
        results = evaluate(
            deployment_file(call.scenario),
            seeds(call.seeds),
            call.out,
            call.arm,
            call.set,
            call.jobs,
            call.limit,
            vision=None if call.vision is None else call.vision == "on",
            fresh=call.fresh,
            cluster=call.dask,
            record=call.record,
        )
    if call.json:
        print(json.dumps(outcome(results), indent=1))
    else:
        print(summary(results))
        print(f"written to {call.out}")
    return 0 if all(run["success"] for run in results["runs"]) else 1


@contextmanager
def _progress_to_stderr() -> Iterator[None]:
    """What this process and the runs' own say goes to the standard error: theirs by the file descriptor."""
    kept = os.dup(1)
    os.dup2(2, 1)
    try:
        with redirect_stdout(sys.stderr):
            yield
    finally:
        os.dup2(kept, 1)
        os.close(kept)
