"""`surefoot plot`: a picture of a recording."""

from __future__ import annotations

import argparse
from pathlib import Path

from surefoot.tools.commands.call import CallError

_WHATS = "probing, forces, displacement, support, states, path, estimator, timing"


def add(commands: argparse._SubParsersAction) -> None:
    """Add the command to the parser."""
    parser = commands.add_parser(
        "plot",
        help="draw a picture of a recording: forces of a probe, support margin, timing, ...",
        formatter_class=argparse.RawDescriptionHelpFormatter,
        description="Draws one picture of a recording. What there is:\n\n"
        "  probing       Fig. 9 of one probe: forces, support polygon, margin, displacement\n"
        "  forces        Fig. 10: what was asked, planned, estimated, true; one probe or the first of each leg\n"
        "  displacement  force against displacement of the foot, a curve for each press\n"
        "  support       how far the centre of mass is inside the feet that carry\n"
        "  states        states of the machine and verdicts over time\n"
        "  path          the way and its footholds from above\n"
        "  estimator     estimate against truth (recordings of the simulator)\n"
        "  timing        step times of the processes\n\n"
        "exit code: 0 done; 2 the call was wrong, or the recording cannot be read",
        epilog="examples:\n  surefoot plot out.mcap --what probing --leg FL --probe 2 --out probe.png\n"
        "  surefoot plot out.mcap --what timing --out timing.html",
    )
    parser.add_argument("recording", type=Path)
    parser.add_argument("--what", default="probing", metavar="NAME", help=f"{_WHATS}; probing when not given")
    parser.add_argument("--leg", default="", metavar="FL", help="of one leg only: FL, FR, RL or RR")
    parser.add_argument(
        "--probe", type=int, default=0, metavar="K", help="the K-th probe, of the leg or of the run, from 1"
    )
    parser.add_argument(
        "--out", type=Path, help="the picture, .png, .svg or .html; NAME.png beside the recording when not given"
    )
    parser.set_defaults(run=_run)


def _run(call: argparse.Namespace) -> int:
    from surefoot.config.robot import LEGS
    from surefoot.tools.tables.recording_tables import load

    if call.leg and call.leg not in LEGS:
        raise CallError(f"--leg {call.leg}: no such leg; there are {', '.join(LEGS)}")
    if call.probe < 0:
        raise CallError(f"--probe {call.probe}: probes are counted from 1")
    recording = load(call.recording)
    from surefoot.tools.plot.catalogue import DRAWINGS, draw
    from surefoot.tools.plot.choice import Choice
    from surefoot.tools.plot.picture_file import check_ending, write_picture

    out = call.out or call.recording.with_name(f"{call.recording.stem}_{call.what}.png")
    check_ending(out)
    choice = Choice(LEGS.index(call.leg) if call.leg else -1, call.probe)
    figure = draw(recording, call.what, choice)
    write_picture(figure, f"{call.recording.name}: {DRAWINGS[call.what].title}", out)
    for words in recording.missing:
        print(f"missing: {words}")
    print(f"drawn to {out}")
    return 0
