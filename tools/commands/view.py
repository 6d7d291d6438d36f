"""`surefoot view`: a run, or a recording, in the browser."""

from __future__ import annotations

import argparse
from pathlib import Path

from surefoot.tools.commands.bus_call import add_bus_arguments, open_bus
from surefoot.tools.commands.call import CallError

PORT = 8080

_LOWEST = 19  # niceness, of the threads that a run in simulated time may have to wait for

_VIEW = """\
Show a running stack in a browser, or a recording with its time in your hand: the robot, the terrain and the map,
footholds with what was found of them, forces asked and measured, support polygon, planned swing and horizon.

The view is a process of its own. Of a run it keeps the newest message of each stream, draws ten times a second
with the lowest priority, and may be closed, or killed, at any time: the robot does not notice. When a run ends,
its last picture stays and the next run is shown as soon as it is there. Beside the picture a running robot is
commanded, and its settings are tuned.

The page is served to this machine alone. From another one: ssh -L 8080:127.0.0.1:8080 ROBOT

exit code: 0 ended by the user; 2 no stack runs there, the port is taken, or the file cannot be shown
"""


def add(commands: argparse._SubParsersAction) -> None:
    """Add the command to the parser."""
    parser = commands.add_parser(
        "view",
        help="a run, or a recording, in the browser",
        formatter_class=argparse.RawDescriptionHelpFormatter,
        description=_VIEW,
        epilog="examples: surefoot view\n          surefoot view out.mcap --from 12",
    )
    parser.add_argument("recording", nargs="?", type=Path, help="a recording; without one, the running stack")
    parser.add_argument("--port", type=int, default=PORT, help=f"of the page; 0 any that is free; default {PORT}")
    parser.add_argument(
        "--from", dest="from_t", type=float, metavar="T", help="begin at this time of the recording"
    )
    parser.add_argument("--wait", action="store_true", help="wait for a stack, if none runs yet")
    add_bus_arguments(parser)
    parser.add_argument("--parent", type=int, default=0, help=argparse.SUPPRESS)
    parser.set_defaults(run=_run)


def check_view(port: int) -> None:
    """See that a view can be shown, before anything is started for it.

    Raises:
        CallError: its packages are missing, or the port is taken.
    """
    try:
        from surefoot.tools.view.page import check_port
    except ModuleNotFoundError as error:
        raise CallError(f"the view needs the package {error.name}: pip install 'surefoot[view]'") from None
    check_port(port)


def _run(call: argparse.Namespace) -> int:
    check_view(call.port)

    import os
    import signal

    from surefoot.bus.session import keep_to_one_thread
    from surefoot.components.process_end import ProcessEnd
    from surefoot.components.real_time import give_way
    from surefoot.tools.view.bus_source import BusSource
    from surefoot.tools.view.page import Page
    from surefoot.tools.view.recording_source import RecordingSource
    from surefoot.tools.view.source import Source

    # In simulated time publishers wait for every reader: one that is stopped would stop the run.
    signal.signal(signal.SIGTSTP, signal.SIG_IGN)
    source: Source
    if call.recording is not None:
        source = RecordingSource(call.recording, call.from_t)
    else:
        keep_to_one_thread()
        os.nice(_LOWEST - os.nice(0))
        source = BusSource(lambda: open_bus(call), call.wait)
        give_way()
    end = ProcessEnd(call.parent)
    page = Page(source, call.port)
    if source.words:
        print(source.words, flush=True)
    print(f"view: {page.url}; Ctrl-C ends it", flush=True)
    try:
        page.run(lambda: end.due)
    finally:
        page.close()
    return 0
