"""The `surefoot` command."""

from __future__ import annotations

import argparse
import os
import sys

from surefoot.tools.blas_threads import BLAS_THREADS

for _name in BLAS_THREADS:
    # Before numpy is imported: its threads would fight the control chain for the cores.
    os.environ.setdefault(_name, "1")

from surefoot.bus.errors import BusError, MessageError  # noqa: E402
from surefoot.config.typed_toml import ConfigError  # noqa: E402
from surefoot.tools.commands import (  # noqa: E402
    bench,
    calibrate,
    child,
    command,
    completion,
    cut,
    doctor,
    drive,
    emulated,
    emulator,
    eval,
    export,
    faults,
    heartbeat,
    info,
    keys,
    plot,
    press,
    record,
    replay,
    report,
    reproduce,
    restart,
    run,
    service,
    soak,
    status,
    stop,
    topics,
    tune,
    video,
    view,
)
from surefoot.tools.commands.call import CallError  # noqa: E402

COMMANDS = (
    *(run, drive, command, tune, stop, cut, heartbeat),
    *(status, view, restart, child, topics, keys),
    *(doctor, calibrate, service, emulator, emulated),
    *(record, info, replay),
    *(plot, report, video, export),
    *(eval, press, reproduce, faults, bench, soak),
    *(completion,),
)
"""In the order of the help."""

_EPILOG = """\
exit code: 0 done; 1 it was done and went wrong: the robot fell, a check failed, something differs; 2 the call was
wrong, or there is nothing it could be done with: no such file, no stack that runs; 130 ended with Ctrl-C where
that is not its ordinary end. `surefoot COMMAND --help` says what they mean there.

example: surefoot run planks
"""


def make_parser() -> argparse.ArgumentParser:
    """The parser of all commands."""
    parser = argparse.ArgumentParser(
        "surefoot",
        formatter_class=argparse.RawDescriptionHelpFormatter,
        description="A quadruped that tests the ground before it trusts it.",
        epilog=_EPILOG,
    )
    subparsers = parser.add_subparsers(required=True, metavar="COMMAND")
    for each in COMMANDS:
        each.add(subparsers)
    return parser


def main(arguments: list[str] | None = None) -> int:
    """Run one command; returns the exit code, as the help tells it.

    Only what a user can mend is told in a line. An error of the program keeps its traceback: a process's log
    is where it will be looked for.
    """
    call = make_parser().parse_args(arguments)
    try:
        return call.run(call)
    except MessageError:
        raise  # a component has published what its topic does not allow
    except (CallError, ConfigError, BusError) as error:
        print(f"surefoot: {error}", file=sys.stderr)
        return 2
    except KeyboardInterrupt:
        return 130


if __name__ == "__main__":
    sys.exit(main())
