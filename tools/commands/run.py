"""`surefoot run`: every process of a deployment."""

from __future__ import annotations

import argparse
from pathlib import Path

from surefoot.tools.commands.call import deployment_file
from surefoot.tools.commands.view import PORT

_RUN = """\
Start every process of a deployment and show how it goes, on one screen.

The run ends when the goal is reached (on the planks: the platform is crossed), when the robot has fallen, has lost
its estimate or is damped with `surefoot command damp`, after --for seconds of its time, or with Ctrl-C; then every
process is ended in order. Before that a robot that stands sits down, unless it is simulated on simulated time;
a second Ctrl-C does not wait for it. A robot that finds no safe foothold goes back to
its last one and stands: on a terminal the run goes on and waits for `surefoot command backward` (or left,
right, forward, stop) from another one; with --plain, or without a terminal, that ends the run. So it is with a
robot whose safety gate has latched: it lies, and waits for `surefoot command sit`, then `stand`.

A real robot, or an emulated one, is examined first (`surefoot doctor`) and, on a terminal, brought up step by
step: each motion is asked for, and n leaves it damped. Without a terminal, or with --plain, nothing is asked: it
stays damped until `surefoot command stand`.

With the simulated clock time waits for every process: the run may be slower than real time, and
`surefoot restart NAME` goes on exactly where the process stood. With --set run.clock=monotonic it keeps real
time; a machine that cannot solve the MPC fast enough says so and runs its light profile. A process that is
restarted is relieved by another that is ready: estimator, wbc and fsm while the robot rests, the others at any
time.

--reload, with the simulated clock, watches the project's source files: a change restarts just the processes that
import the changed file, once it compiles; one that fails with the new source waits for the next change.
`surefoot child CONFIG NAME` in another terminal takes the place of one process, under a debugger if you like.

`surefoot stop` lets the robot sit down and be damped, `surefoot cut` takes its torque away; the run stays up.

--record OUT.mcap writes all that is published and what every step has read: see `surefoot info` and `replay`.

--view shows the run in a browser, from a process of its own: see `surefoot view`.

With --host NAME it starts what network.hosts gives that machine, and connects to the robot's. Start the robot's
machine and this one in any order within a minute; each part ends by itself or with Ctrl-C.

exit code: 0 goal reached, time up or ended by the user; 1 fell, stopped or a process failed; 2 the call was wrong
"""


def add(commands: argparse._SubParsersAction) -> None:
    """Add the command to the parser."""
    parser = commands.add_parser(
        "run",
        help="start every process of a deployment",
        formatter_class=argparse.RawDescriptionHelpFormatter,
        description=_RUN,
        epilog="examples: surefoot run planks\n          surefoot run flat --set run.command=stand --reload",
    )
    parser.add_argument("config", nargs="?", default="planks", help="a deployment file, or its name in config/")
    parser.add_argument("--set", action="append", default=[], metavar="KEY=VALUE", help="override a setting")
    parser.add_argument(
        "--for", dest="seconds", type=float, default=0.0, help="end after this much of the run's time"
    )
    parser.add_argument("--host", metavar="NAME", help="this machine's name in network.hosts; default: that of io")
    parser.add_argument("--plain", action="store_true", help="lines instead of a screen")
    parser.add_argument(
        "--reload", action="store_true", help="restart the processes whose source changes (simulated clock)"
    )
    parser.add_argument(
        "--beat", action="store_true", help="be the operator's heartbeat, where operator.heartbeat_s asks for one"
    )
    parser.add_argument("--record", type=Path, metavar="OUT.mcap", help="record everything that is published")
    parser.add_argument("--view", action="store_true", help="show the run in a browser")
    parser.add_argument(
        "--view-port", type=int, metavar="PORT", help=f"of the view's page; 0 any that is free; default {PORT}"
    )
    parser.set_defaults(run=_run)


def _run(call: argparse.Namespace) -> int:
    from surefoot.tools.live_run import RunCall, live_run

    port = PORT if call.view_port is None else call.view_port
    host = [f"network.host={call.host}"] if call.host else []
    return live_run(
        RunCall(
            config=deployment_file(call.config),
            overrides=(*call.set, *host),
            seconds=call.seconds,
            plain=call.plain,
            reload=call.reload,
            record=call.record,
            beats=call.beat,
            view=port if call.view or call.view_port is not None else None,
        )
    )
