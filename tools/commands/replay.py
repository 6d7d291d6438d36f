"""`surefoot replay`: run components of a recording again, or play it back on the bus."""

from __future__ import annotations

import argparse
from pathlib import Path

from surefoot.tools.commands.call import CallError

_HELP = """\
Run components again on exactly the messages that each of their steps has read, and compare what they publish
with what was recorded, byte for byte (but for measurements of the machine such as solve times). Components of
another version than the one that was recorded show where their behaviour has changed.

With --publish the recording is played back on a bus of its own instead, for viewers.

exit code: 0 equal, or --check was not given; 1 something differs; 2 the call was wrong
"""


def add(commands: argparse._SubParsersAction) -> None:
    """Add the command to the parser."""
    parser = commands.add_parser(
        "replay",
        help="run components of a recording again, or play it back",
        formatter_class=argparse.RawDescriptionHelpFormatter,
        description=_HELP,
        epilog="examples:\n  surefoot replay out.mcap --run wbc --check\n"
        "  surefoot replay out.mcap --run estimator,fsm --diff\n  surefoot replay out.mcap --publish --speed 1",
    )
    parser.add_argument("recording", type=Path)
    parser.add_argument(
        "--run",
        dest="processes",
        default="all",
        metavar="NAMES",
        help="estimator,wbc or all; what one publishes the next reads",
    )
    parser.add_argument("--check", action="store_true", help="exit code 1 if anything differs")
    parser.add_argument("--diff", action="store_true", help="show the first differing field of each topic")
    parser.add_argument(
        "--from", dest="begin", type=float, default=float("-inf"), metavar="T", help="run's time [s]"
    )
    parser.add_argument(
        "--until", dest="end", type=float, default=float("inf"), metavar="T", help="run's time [s]"
    )
    parser.add_argument(
        "--set", action="append", default=[], metavar="KEY=VALUE", help="another setting than the recorded one"
    )
    parser.add_argument("--publish", action="store_true", help="play back on the bus")
    parser.add_argument("--speed", type=float, default=1.0, help="seconds of the run for each on the wall")
    parser.add_argument("--namespace", default="surefoot", help="of the bus that is played on")
    parser.set_defaults(run=_run)


def _run(call: argparse.Namespace) -> int:
    from rich.console import Console

    console = Console(soft_wrap=True, highlight=False)
    if call.publish:
        from surefoot.tools.recording.playback import playback

        if not 0.01 <= call.speed <= 100.0:
            raise CallError(f"--speed {call.speed:g}: allowed 0.01 to 100")
        playback(call.recording, call.namespace, call.speed, call.begin, call.end, console.print)
        return 0
    from surefoot.tools.recording.replay import replay
    from surefoot.tools.recording.replay_table import table

    result = replay(call.recording, _processes(call.processes), call.begin, call.end, call.set)
    console.print(*table(call.recording, result, call.diff), sep="\n")
    return 1 if call.check and not (result.comparison.equal and not any(result.left_out.values())) else 0


def _processes(text: str) -> list[str]:
    from surefoot.bus.topics import PROCESSES

    if text == "all":
        return [name for name in PROCESSES if name != "io"]  # io is the robot
    names = text.split(",")
    for name in names:
        if name not in PROCESSES:
            raise CallError(f"--run {text!r}: no process {name!r}; there are all, {', '.join(PROCESSES)}")
    return names
