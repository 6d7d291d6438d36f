"""`surefoot emulator`: an Aliengo on a UDP port of this machine."""

from __future__ import annotations

import argparse
import sys

from surefoot.tools.commands.call import deployment_file

_EMULATOR = """\
An Aliengo that is not there: it speaks the real one's packets on a UDP port, and MuJoCo moves it. It answers when
it is spoken to. In another terminal `surefoot run aliengo_emulated --beat` talks to it as `surefoot run aliengo`
does to the real one; `surefoot command stand` gets it up.

What goes wrong is set under `emulator`: loss, delay, order and damage of packets in either direction, stuck
sensors, dead and hot motors, what the robot does when commands stop. See docs/hardware.md.

With --set emulator.pace=packets its time goes on by 2 ms with each command: then
`surefoot run aliengo_emulated --set run.clock=simulated --set hw.aliengo.exchange=cycle` takes the time it needs.

exit code: 0 ended by the user; 1 the physics diverged or the port is taken; 2 the call was wrong
"""


def add(commands: argparse._SubParsersAction) -> None:
    """Add the command to the parser."""
    parser = commands.add_parser(
        "emulator",
        help="an Aliengo on a UDP port, simulated",
        formatter_class=argparse.RawDescriptionHelpFormatter,
        description=_EMULATOR,
        epilog="example: surefoot emulator --terrain planks --set emulator.states.loss=0.02",
    )
    parser.add_argument(
        "scenario", nargs="?", default="aliengo_emulated", help="a deployment file, or its name in config/"
    )
    parser.add_argument("--terrain", metavar="KIND", help="the ground beneath it, such as planks")
    parser.add_argument("--port", type=int, help="where it answers; that of the scenario when not given")
    parser.add_argument("--generation", choices=("G0", "G1"), help="of its packets; likewise")
    parser.add_argument("--set", action="append", default=[], metavar="KEY=VALUE", help="override a setting")
    parser.set_defaults(run=_run)


def _run(call: argparse.Namespace) -> int:
    from surefoot.config.deployment import load_deployment
    from surefoot.hw.emulator.server import EmulatorServer
    from surefoot.hw.errors import HardwareFault
    from surefoot.tools.end_signals import heed

    given = {
        "terrain.kind": call.terrain,
        "hw.aliengo.port": call.port,
        "hw.aliengo.generation": call.generation,
    }
    overrides = [f"{key}={value}" for key, value in given.items() if value is not None]
    deployment = load_deployment(deployment_file(call.scenario), [*overrides, *call.set])
    settings, generation = deployment.emulator, deployment.hw.aliengo.generation
    heed()
    try:
        server = EmulatorServer(deployment)
        print(
            f"an Aliengo of generation {generation} on {deployment.terrain.kind} ground answers at "
            f"{settings.listen}:{server.port}, its time follows the {settings.pace}; Ctrl-C ends it",
            flush=True,
        )
        server.serve(lambda: False)
    except HardwareFault as error:
        print(f"surefoot: {error}", file=sys.stderr)
        return 1
    except KeyboardInterrupt:
        robot = server.robot
        print(f"\n{robot.witness}")
        refused = f", {robot.refused} refused: {robot.trouble}" if robot.refused else ""
        lag = f"; this machine was {server.lag_s:.1f} s too slow" if server.lag_s else ""
        print(f"{robot.t:.1f} s, {robot.commands} commands, {server.answers} answers{refused}{lag}")
    return 0
