"""`surefoot press`: draw where a terrain gives way."""

from __future__ import annotations

import argparse
from pathlib import Path

from surefoot.tools.commands.call import deployment_file

_PRESS = """\
Press a foot-sized sphere into every point of a terrain and draw how far it sinks; the line is where it is called a
collapse.

exit code: 0 drawn; 2 the call was wrong
"""


def add(commands: argparse._SubParsersAction) -> None:
    """Add the command to the parser."""
    parser = commands.add_parser(
        "press",
        help="draw where a terrain gives way under a force",
        formatter_class=argparse.RawDescriptionHelpFormatter,
        description=_PRESS,
        epilog="example: surefoot press planks --force 110 --out map.png",
    )
    parser.add_argument("scenario", help="a deployment file, or its name in config/")
    parser.add_argument("--force", type=float, default=110.0, help="normal force [N]; 110 when not given")
    parser.add_argument("--step", type=float, default=0.01, help="from point to point [m]; 0.01 when not given")
    parser.add_argument("--seed", type=int, help="of what the terrain leaves to chance")
    parser.add_argument("--set", action="append", default=[], metavar="KEY=VALUE", help="override a setting")
    parser.add_argument(
        "--out", type=Path, required=True, help="the picture, a .png; its figures go beside as .csv"
    )
    parser.set_defaults(run=_run)


def _run(call: argparse.Namespace) -> int:
    from surefoot.config.deployment import load_deployment
    from surefoot.tools.evaluation.label_map import check_drawing, draw, press_terrain

    check_drawing(call.out)
    seed = [] if call.seed is None else [f"hw.seed={call.seed}"]
    scenario = deployment_file(call.scenario)
    deployment = load_deployment(scenario, [*call.set, *seed])
    label = press_terrain(deployment, call.force, call.step)
    title = f"{scenario.stem}, seed {deployment.hw.seed}: pressed with {call.force:g} N"
    draw(label, title, call.out)
    share = 100.0 * label.collapsible.mean()
    print(f"{share:.0f} % of the points give way; drawn to {call.out}, figures in {call.out.with_suffix('.csv')}")
    return 0
