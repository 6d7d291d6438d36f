"""`surefoot info`: what is in a recording, and what is missing."""

from __future__ import annotations

import argparse
from pathlib import Path

_INFO = """\
List the topics and processes of a recording and say what is missing of them, also of a file that was cut off
because its recorder was killed.

exit code: 0 nothing is missing; 1 something is; 2 the call was wrong, or the file cannot be read
"""


def add(commands: argparse._SubParsersAction) -> None:
    """Add the command to the parser."""
    parser = commands.add_parser(
        "info",
        help="what is in a recording, and what is missing",
        formatter_class=argparse.RawDescriptionHelpFormatter,
        description=_INFO,
        epilog="examples: surefoot info out.mcap\n          surefoot info out.mcap --json | jq .gaps",
    )
    parser.add_argument("recording", type=Path)
    parser.add_argument("--json", action="store_true", help="for scripts")
    parser.add_argument("--config", action="store_true", help="print the configuration that was recorded, as JSON")
    parser.set_defaults(run=_run)


def _run(call: argparse.Namespace) -> int:
    import json

    from rich.console import Console

    from surefoot.bus.recording.reader import Recording
    from surefoot.tools.recording.contents import Contents
    from surefoot.tools.recording.contents_table import as_json, table

    if call.config:
        print(json.dumps(Recording(call.recording).config, indent=1))
        return 0
    contents = Contents(call.recording)
    if call.json:
        print(json.dumps(as_json(contents), indent=1))
    else:
        Console(soft_wrap=True, highlight=False).print(*table(contents), sep="\n")
    return 1 if contents.gaps else 0
