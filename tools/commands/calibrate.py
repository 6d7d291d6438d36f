"""`surefoot calibrate`: measure the offsets of one robot's sensors."""

from __future__ import annotations

import argparse
import sys
from pathlib import Path

from surefoot.tools.commands.bus_call import add_bus_arguments, open_bus
from surefoot.tools.commands.call import CallError, deployment_file

_CALIBRATE = """\
Measure what one robot's sensors read when there is nothing to read, and write it to a robot file; with
hw.unit = "FILE" io takes it off every reading. What the file holds already and is not measured anew stays.

--hung     the robot hangs, its feet free, and no stack runs: biases of the IMU, torque offset and noise, zeros of
           the foot sensors. Damped; then, with your yes, each joint in turn swings slowly: friction. Ctrl-C ends
           it, and so does a stop or a cut at the robot's remote.
--standing the stack runs, and the robot stands still (surefoot command stand): biases of the IMU, scale of the
           foot sensors. Nothing is moved. Hung up first, with the same --out, it knows the torque offsets.

A robot that moves, is tilted or is not in the pose that was said is refused. See docs/calibration.md.

exit code: 0 written; 1 refused, or no way to the robot; 2 the call was wrong
"""


def add(commands: argparse._SubParsersAction) -> None:
    """Add the command to the parser."""
    parser = commands.add_parser(
        "calibrate",
        help="measure the offsets of one robot's sensors",
        formatter_class=argparse.RawDescriptionHelpFormatter,
        description=_CALIBRATE,
        epilog="examples: surefoot calibrate aliengo --hung --out unit.toml\n"
        "          surefoot calibrate aliengo --standing --level-floor --out unit.toml",
    )
    parser.add_argument("config", help="a deployment file, or its name in config/")
    pose = parser.add_mutually_exclusive_group(required=True)
    pose.add_argument("--standing", action="store_true", help="it stands, under a running stack")
    pose.add_argument("--hung", action="store_true", help="it hangs, and no stack runs")
    parser.add_argument("--out", type=Path, required=True, metavar="UNIT.toml", help="the robot file")
    parser.add_argument(
        "--level-floor", action="store_true", help="standing: the floor is level, as a spirit level says"
    )
    parser.add_argument(
        "--attitudes",
        type=int,
        default=1,
        metavar="N",
        help="hung: read the accelerometer in N attitudes of the trunk, 3 to 20; default 1: along gravity only",
    )
    parser.add_argument("--set", action="append", default=[], metavar="KEY=VALUE", help="override a setting")
    add_bus_arguments(parser)
    parser.set_defaults(run=_run)


def _run(call: argparse.Namespace) -> int:
    from surefoot.config.deployment import load_deployment
    from surefoot.hw.errors import HardwareFault
    from surefoot.tools.calibration.refusal import CannotCalibrate
    from surefoot.tools.calibration.result import told
    from surefoot.tools.calibration.unit_file import known_unit, write_unit

    _check(call)
    deployment = load_deployment(deployment_file(call.config), call.set)
    unit = known_unit(call.out, deployment.robot)
    try:
        result = (_hung if call.hung else _standing)(call, deployment, unit)
    except (CannotCalibrate, HardwareFault) as error:
        print(f"surefoot: {error}", file=sys.stderr)
        return 1
    write_unit(call.out, result.unit)
    print(told(result))
    print(f'written to {call.out}; apply it with --set hw.unit={call.out}, or hw.unit = "{call.out}" in the file')
    return 0


def _check(call: argparse.Namespace) -> None:
    if call.attitudes != 1 and not (call.hung and 3 <= call.attitudes <= 20):
        raise CallError(f"--attitudes {call.attitudes}: 3 to 20, with --hung")
    if call.level_floor and not call.standing:
        raise CallError("--level-floor: with --standing; a hung robot does not know the floor")
    if not call.out.resolve().parent.is_dir():
        raise CallError(f"--out {call.out}: there is no folder {call.out.parent}")


def _hung(call: argparse.Namespace, deployment, unit):
    from surefoot.tools.calibration.hung import calibrate_hung
    from surefoot.tools.calibration.unit_file import now

    return calibrate_hung(deployment, unit, call.attitudes, now(), _asked)


def _standing(call: argparse.Namespace, deployment, unit):
    from surefoot.config.unit import Measured
    from surefoot.tools.calibration.bus_samples import check_raw, hear_standing
    from surefoot.tools.calibration.standing import measure_standing
    from surefoot.tools.calibration.unit_file import now

    session = open_bus(call)
    try:
        check_raw(session, deployment.robot)
        print(
            f"connected to {session.where}; measuring {deployment.calibration.seconds:g} s of the run", flush=True
        )
        samples = hear_standing(session, deployment.calibration.seconds)
    finally:
        session.close()
    measured = Measured(now(), "standing", samples.seconds)
    return measure_standing(samples, deployment, unit, call.level_floor, measured)


def _asked(question: str) -> bool:
    try:
        return input(f"{question}\ntype yes to go on: ").strip().lower() == "yes"
    except EOFError:
        return False
