"""`surefoot faults`: the fault drill."""

from __future__ import annotations

import argparse
from pathlib import Path

from surefoot.tools.commands.call import CallError, deployment_file

_CLOCKS = ("simulated", "monotonic")

_DRILL = """\
Kill, pause and restart every process in every phase of live runs, and write what came of it to a page.

With the simulated clock the run must go on with the same bytes as without the fault; on the monotonic clock the
robot must stay up or reach its declared safe state (docs/faults.md). The whole drill takes about an hour.

With --robot it is the emulated robot and its link that break, in simulated time, standing and in a swing; the page
tells after how many cycles no motor was driven any more (docs/hardware_faults.md).

exit code: 0 all went as declared; 1 something did not; 2 the call was wrong
"""


def add(commands: argparse._SubParsersAction) -> None:
    """Add the command to the parser."""
    parser = commands.add_parser(
        "faults",
        help="kill, pause and restart every process in every phase",
        formatter_class=argparse.RawDescriptionHelpFormatter,
        description=_DRILL,
        epilog="example: surefoot faults flat --clock simulated --phase swing --out faults.md",
    )
    parser.add_argument("config", nargs="*", help="deployment files, or names in config/; flat and planks if none")
    parser.add_argument("--clock", action="append", help="simulated or monotonic; both if none")
    parser.add_argument("--phase", action="append", help="standing, 'base shift', swing or probing; all if none")
    parser.add_argument("--set", action="append", default=[], metavar="KEY=VALUE", help="override a setting")
    parser.add_argument("--robot", action="store_true", help="break the emulated robot and its link instead")
    parser.add_argument("--out", type=Path, required=True, help="the page, in Markdown")
    parser.set_defaults(run=_run)


def _run(call: argparse.Namespace) -> int:
    from surefoot.tools.faults.case import PHASES
    from surefoot.tools.faults.page import drill_page
    from surefoot.tools.faults.robot_page import robot_page

    def say(words: str) -> None:
        print(words, flush=True)

    if call.robot:
        if call.clock or call.phase or len(call.config) > 1:
            raise CallError("--robot has its own clock and phases, and one deployment, such as planks_emulated")
        config = deployment_file(call.config[0] if call.config else "planks_emulated")
        return 0 if robot_page(config, call.set, call.out, say) else 1
    clocks = _among(call.clock, _CLOCKS, "--clock")
    phases = _among(call.phase, PHASES, "--phase")
    configs = [deployment_file(name) for name in call.config or ("flat", "planks")]
    good = drill_page(configs, clocks, phases, call.set, call.out, say)
    return 0 if good else 1


def _among(given: list[str] | None, allowed: tuple[str, ...], option: str) -> tuple[str, ...]:
    for each in given or ():
        if each not in allowed:
            raise CallError(f"{option} {each!r}: there are {', '.join(allowed)}")
    return tuple(given or allowed)
