"""`surefoot report`: the story of a recording on one page."""

from __future__ import annotations

import argparse
from pathlib import Path


def add(commands: argparse._SubParsersAction) -> None:
    """Add the command to the parser."""
    parser = commands.add_parser(
        "report",
        help="tell the story of a recording on one page",
        formatter_class=argparse.RawDescriptionHelpFormatter,
        description="Writes one HTML page that needs nothing else: the map of the path with every foothold and\n"
        "what came of it, a table of the probes, a time line of states, why the run ended, settings and\n"
        "versions. It prints well. What the recording does not hold is left out.\n\n"
        "exit code: 0 done; 2 the call was wrong, or the recording cannot be read",
        epilog="example: surefoot report out.mcap --out run.html",
    )
    parser.add_argument("recording", type=Path)
    parser.add_argument(
        "--out", type=Path, required=True, metavar="FILE.html|DIR", help="the page, or a folder for index.html"
    )
    parser.set_defaults(run=_run)


def _run(call: argparse.Namespace) -> int:
    from surefoot.tools.tables.recording_tables import load

    recording = load(call.recording)
    from surefoot.tools.story.page import write_story

    path = write_story(recording, call.out, print)
    print(f"written to {path}")
    return 0
