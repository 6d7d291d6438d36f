"""`surefoot record`: record a running stack."""

from __future__ import annotations

import argparse
from pathlib import Path

from surefoot.tools.commands.bus_call import add_bus_arguments, open_bus

_HELP = """\
Record everything that a running stack publishes, and which messages each of its steps read, until Ctrl-C or the
end of the run. The processes keep their journals themselves and hand them over ten times a second, so that nothing
is lost however busy the bus is.

exit code: 0 all that was asked for is in the file; 1 it could not be written to the end, or something is missing;
2 the call was wrong, or no stack runs there
"""


def add(commands: argparse._SubParsersAction) -> None:
    """Add the command to the parser."""
    parser = commands.add_parser(
        "record",
        help="record a running stack",
        formatter_class=argparse.RawDescriptionHelpFormatter,
        description=_HELP,
        epilog="example: surefoot record out.mcap",
    )
    parser.add_argument("out", type=Path, help="an MCAP file; it is overwritten")
    add_bus_arguments(parser)
    parser.add_argument("--parent", type=int, default=0, help=argparse.SUPPRESS)
    parser.set_defaults(run=_run)


def _run(call: argparse.Namespace) -> int:
    from surefoot.bus.errors import RecordingError
    from surefoot.components.process_end import ProcessEnd
    from surefoot.tools.recording.recorder import Recorder, check_space, connect

    warning = check_space(call.out)
    if warning:
        print(warning, flush=True)
    end = ProcessEnd(call.parent)
    session = connect(call.namespace, lambda: end.due) if call.parent else open_bus(call)
    recorder = Recorder(session, call.out)
    print(f"recording namespace {session.namespace!r} to {call.out}; Ctrl-C ends it", flush=True)
    try:
        recorder.run(lambda: end.due)
    except RecordingError as error:
        print(error, flush=True)
        return 1
    finally:
        session.close()
    for each in recorder.lost:
        print(f"lost: {each}", flush=True)
    print(recorder.summary(), flush=True)
    return 1 if recorder.lost else 0
