"""`surefoot export`: a recording, or its robot, for other programs."""

from __future__ import annotations

import argparse
from pathlib import Path

from surefoot.tools.commands.call import CallError

_KINDS = ("json-mcap", "csv", "parquet", "urdf", "mjcf")
_ENDINGS = {"json-mcap": ".mcap", "urdf": ".urdf", "mjcf": ".xml"}


def add(commands: argparse._SubParsersAction) -> None:
    """Add the command to the parser."""
    parser = commands.add_parser(
        "export",
        help="write a recording for Foxglove, PlotJuggler or a spreadsheet, or its robot as URDF or MJCF",
        formatter_class=argparse.RawDescriptionHelpFormatter,
        description="Writes a recording in another format:\n\n"
        "  json-mcap  one MCAP file with messages in JSON: Foxglove and PlotJuggler open it; without --topics\n"
        "             the robot in three dimensions is in it too\n"
        "  csv        a folder with one file a topic, and columns.csv, which says what they hold\n"
        "  parquet    the same, smaller, and with the fields of open length\n"
        "  urdf       the robot's description\n"
        "  mjcf       the same for MuJoCo\n\n"
        "The MPC's policies and the depth images are nearly all of a recording: json-mcap and parquet have them\n"
        "only when they are named with --topics.\n\n"
        "exit code: 0 done; 2 the call was wrong, or the recording cannot be read",
        epilog="examples:\n  surefoot export out.mcap --to json-mcap --out foxglove.mcap\n"
        "  surefoot export out.mcap --to csv --topics state/estimate,sim/truth --out numbers\n"
        "  surefoot export aliengo --to urdf --out aliengo.urdf",
    )
    parser.add_argument("recording", help="for urdf and mjcf also the name of a robot in config/robots/")
    parser.add_argument("--to", required=True, choices=_KINDS, help="the format")
    parser.add_argument("--out", type=Path, required=True, help="a file; for csv and parquet a folder")
    parser.add_argument(
        "--topics", default="", metavar="KEYS", help="state/estimate,sim/truth; all when not given"
    )
    parser.add_argument(
        "--from", dest="begin", type=float, default=float("-inf"), metavar="T", help="run's time [s]"
    )
    parser.add_argument(
        "--until", dest="end", type=float, default=float("inf"), metavar="T", help="run's time [s]"
    )
    parser.set_defaults(run=_run)


def _run(call: argparse.Namespace) -> int:
    ending = _ENDINGS.get(call.to)
    if ending and call.out.suffix != ending:
        raise CallError(f"--out {call.out}: --to {call.to} writes a file that ends in {ending}")
    if ending and not call.out.parent.is_dir():
        raise CallError(f"--out {call.out}: there is no folder {call.out.parent}; make it first")
    if not ending and call.out.exists() and not call.out.is_dir():
        raise CallError(f"--out {call.out}: --to {call.to} writes a folder, and that is a file")
    return _describe(call) if call.to in ("urdf", "mjcf") else _convert(call)


def _describe(call: argparse.Namespace) -> int:
    """Write the description of a recording's robot, or of one that is named."""
    from surefoot.config.robot import load_robot
    from surefoot.tools.tables.recording_tables import load

    is_file = Path(call.recording).suffix == ".mcap" or Path(call.recording).is_file()
    robot = load(call.recording).deployment.load_robot() if is_file else load_robot(call.recording)
    if call.to == "urdf":
        from surefoot.tools.export.urdf import urdf

        call.out.write_text(urdf(robot))
    else:
        from surefoot.tools.export.mjcf import mjcf

        call.out.write_text(mjcf(robot))
    print(f"{robot.name} written to {call.out}")
    return 0


def _convert(call: argparse.Namespace) -> int:
    from surefoot.tools.export.contents import contents
    from surefoot.tools.tables.recording_tables import load

    recording = load(call.recording)
    topics = [key for key in call.topics.split(",") if key]
    wanted = contents(recording, topics, call.begin, call.end, bulky=call.to == "csv")
    if call.to == "json-mcap":
        from surefoot.tools.export.json_mcap import write_json_mcap

        if call.out.resolve() == recording.path.resolve():
            raise CallError(f"--out {call.out}: that is the recording itself; give another name")
        print(f"{write_json_mcap(recording, wanted, call.out)} messages of {', '.join(wanted.keys)}")
    else:
        from surefoot.tools.export.numbers import write_csv, write_parquet

        write = write_csv if call.to == "csv" else write_parquet
        write(recording, wanted, call.out, print)
    if wanted.left_out:
        print(f"left out, name them with --topics: {', '.join(wanted.left_out)}")
    for words in recording.missing:
        print(f"missing: {words}")
    print(f"written to {call.out}")
    return 0
