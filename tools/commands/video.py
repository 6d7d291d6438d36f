"""`surefoot video`: a recording as an MP4."""

from __future__ import annotations

import argparse
from pathlib import Path

from surefoot.tools.commands.call import CallError


def add(commands: argparse._SubParsersAction) -> None:
    """Add the command to the parser."""
    parser = commands.add_parser(
        "video",
        help="render a recording as an MP4, without a display",
        formatter_class=argparse.RawDescriptionHelpFormatter,
        description="Renders what the simulator would have shown of a recording: the truth where it was\n"
        "recorded, otherwise the estimate. Arrows are the forces on the feet, orange on the leg whose turn it\n"
        "is; discs are the verdicts on footholds.\n\n"
        "exit code: 0 done; 2 the call was wrong, or the recording cannot be read",
        epilog="example: surefoot video out.mcap --out run.mp4 --speed 4 --from 20 --until 60",
    )
    parser.add_argument("recording", type=Path)
    parser.add_argument("--out", type=Path, required=True, help="the film, an .mp4")
    parser.add_argument("--speed", type=float, default=1.0, help="seconds of the run for each of the film")
    parser.add_argument("--fps", type=int, default=30, help="frames a second; 30 when not given")
    parser.add_argument("--size", default="960x540", metavar="WxH", help="in pixels; 960x540 when not given")
    parser.add_argument(
        "--from", dest="begin", type=float, default=float("-inf"), metavar="T", help="run's time [s]"
    )
    parser.add_argument(
        "--until", dest="end", type=float, default=float("inf"), metavar="T", help="run's time [s]"
    )
    parser.set_defaults(run=_run)


def _run(call: argparse.Namespace) -> int:
    from surefoot.tools.video.film import FilmSpec, make_film

    width, height = _size(call.size)
    spec = FilmSpec(
        call.recording, call.out, call.speed, call.fps, width, height, begin_s=call.begin, end_s=call.end
    )
    make_film(spec, print)
    print(f"written to {call.out}")
    return 0


def _size(text: str) -> tuple[int, int]:
    width, _, height = text.partition("x")
    try:
        return int(width), int(height)
    except ValueError:
        raise CallError(f"--size {text}: want WIDTHxHEIGHT in pixels, such as 960x540") from None
