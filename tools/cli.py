"""The `surefoot` command."""

from __future__ import annotations

import argparse
import os
import sys
from pathlib import Path

from surefoot.tools.blas_threads import BLAS_THREADS

for _name in BLAS_THREADS:
    # Before numpy is imported: its threads would fight the control chain for the cores.
    os.environ.setdefault(_name, "1")

from surefoot.bus.errors import BusError, MessageError  # noqa: E402
from surefoot.config.typed_toml import ConfigError  # noqa: E402

_LISTEN_S = 1.5

_RUN = """\
Start every process of a deployment and show how it goes, on one screen.

The run ends when the goal is reached (on the planks: the platform is crossed), when the robot has fallen, has lost
its estimate or is damped with `surefoot command damp`, after --for seconds of its time, or with Ctrl-C; then every
process is ended in order. A robot that finds no safe foothold goes back to
its last one and stands: on a terminal the run goes on and waits for `surefoot command backward` (or left,
right, forward, stop) from another one; with --plain, or without a terminal, that ends the run.

With the simulated clock time waits for every process: the run may be slower than real time, and
`surefoot restart NAME` goes on where the process stood (a restarted fsm stands the robot and waits for a
direction). With --set run.clock=monotonic it keeps real time; a machine that cannot solve the MPC fast
enough says so and runs its light profile, and estimator, wbc and fsm are restarted only while the robot is
damped.

exit code: 0 goal reached, time up or ended by the user; 1 fell, stopped or a process failed; 2 the call was wrong
"""


class CallError(ValueError):
    """A command that cannot be run as it was called; says what would be right."""


def main(arguments: list[str] | None = None) -> int:
    """Run one command; returns the exit code: 0 done, 1 the run failed, 2 the call was wrong.

    Only what a user can mend is told in a line. An error of the program keeps its traceback: a process's log
    is where it will be looked for.
    """
    parser = _parser()
    call = parser.parse_args(arguments)
    try:
        return call.run(call)
    except MessageError:
        raise  # a component has published what its topic does not allow
    except (CallError, ConfigError, BusError) as error:
        print(f"surefoot: {error}", file=sys.stderr)
        return 2
    except KeyboardInterrupt:
        return 130


def _parser() -> argparse.ArgumentParser:
    parser = argparse.ArgumentParser(
        "surefoot", description="A quadruped that tests the ground before it trusts it."
    )
    commands = parser.add_subparsers(required=True, metavar="COMMAND")
    graded = commands.add_parser(
        "eval",
        help="grade the stack in lockstep",
        epilog="example: surefoot eval planks --seeds 0:10 --jobs 2 --out out",
    )
    graded.add_argument("scenario", help="a deployment file, or its name in config/ (flat, planks, rocks, ...)")
    graded.add_argument("--seeds", default="0:10", help="first:last+1, or a list such as 0,3,7")
    graded.add_argument(
        "--arm", default="full", help="full, mpc_only, true_state, ... or NAME=FIGURE; a wrong one lists all"
    )
    graded.add_argument("--vision", choices=("on", "off"), help="with or without the depth camera and its map")
    graded.add_argument("--set", action="append", default=[], metavar="KEY=VALUE", help="override a setting")
    graded.add_argument("--jobs", type=int, default=1, help="runs at the same time")
    graded.add_argument(
        "--dask",
        default="",
        metavar="ADDRESS",
        help="run on the workers of this Dask scheduler instead; they need surefoot[cluster] and the same files",
    )
    graded.add_argument("--limit", type=float, default=1200.0, help="simulated seconds that count as a time-out")
    graded.add_argument("--out", type=Path, required=True, help="folder for results.json and summary.md")
    graded.add_argument(
        "--fresh", action="store_true", help="do seeds again that the folder's results.json has already"
    )
    graded.set_defaults(run=_eval)
    press = commands.add_parser(
        "press",
        help="draw where a terrain gives way under a force",
        description="Presses a foot-sized sphere into every point of a terrain and draws how far it sinks; "
        "the line is where it is called a collapse.",
        epilog="example: surefoot press planks --force 110 --out map.png",
    )
    press.add_argument("scenario", help="a deployment file, or its name in config/")
    press.add_argument("--force", type=float, default=110.0, help="normal force [N]; 110 when not given")
    press.add_argument("--step", type=float, default=0.01, help="from point to point [m]; 0.01 when not given")
    press.add_argument("--seed", type=int, help="of what the terrain leaves to chance")
    press.add_argument("--set", action="append", default=[], metavar="KEY=VALUE", help="override a setting")
    press.add_argument(
        "--out", type=Path, required=True, help="the picture, a .png; its figures go beside as .csv"
    )
    press.set_defaults(run=_press)
    reproduced = commands.add_parser(
        "reproduce",
        help="run the paper's experiments and write one page with its figures",
        epilog="example: surefoot reproduce out --quick. Stopped with Ctrl-C, the same call goes on where it was.",
    )
    reproduced.add_argument("out", type=Path, help="folder for index.html, the figures and the data")
    reproduced.add_argument("--quick", action="store_true", help="a short version, in minutes")
    reproduced.add_argument("--jobs", type=int, default=1, help="runs at the same time")
    reproduced.add_argument("--seeds", default="", help="of every experiment; without it, each one's own")
    reproduced.add_argument(
        "--set", action="append", default=[], metavar="KEY=VALUE", help="of config/reproduce.py: flat_goal_m=0.6"
    )
    reproduced.set_defaults(run=_reproduce)
    run = commands.add_parser(
        "run",
        help="start every process of a deployment",
        formatter_class=argparse.RawDescriptionHelpFormatter,
        description=_RUN,
        epilog="example: surefoot run planks",
    )
    run.add_argument("config", nargs="?", default="planks", help="a deployment file, or its name in config/")
    run.add_argument("--set", action="append", default=[], metavar="KEY=VALUE", help="override a setting")
    run.add_argument(
        "--for", dest="seconds", type=float, default=0.0, help="end after this much of the run's time"
    )
    run.add_argument("--plain", action="store_true", help="lines instead of a screen")
    run.set_defaults(run=_run)
    child = commands.add_parser("child", help="run one process of a deployment in the foreground")
    child.add_argument("config")
    child.add_argument("name", help="io, estimator, wbc, mpc, fsm, trajopt or elevation_map")
    child.add_argument("--set", action="append", default=[], metavar="KEY=VALUE")
    child.add_argument("--boot", type=int, default=0, help="how often this process has been restarted")
    child.add_argument("--parent", type=int, default=0, help="process id that must live on; 0 the caller's")
    child.set_defaults(run=_child)
    command = commands.add_parser("command", help="command the robot of a running stack")
    command.add_argument("command", help="stand, sit, forward, backward, left, right, stop or damp")
    command.add_argument("--namespace", default="surefoot")
    command.set_defaults(run=_command)
    restart = commands.add_parser("restart", help="restart one process of a running stack")
    restart.add_argument("name")
    restart.add_argument("--namespace", default="surefoot")
    restart.set_defaults(run=_restart)
    status = commands.add_parser("status", help="health of a running stack, once")
    status.add_argument("--namespace", default="surefoot")
    status.set_defaults(run=_status)
    bench = commands.add_parser("bench", help="measure the hot paths on this machine")
    bench.set_defaults(run=_bench)
    topics = commands.add_parser("topics", help="list every topic, its type, writer and rate")
    topics.set_defaults(run=_topics)
    return parser


def _eval(call: argparse.Namespace) -> int:
    from surefoot.tools.evaluation.evaluate import evaluate
    from surefoot.tools.evaluation.summary import summary

    results = evaluate(
        _deployment_file(call.scenario),
        _seeds(call.seeds),
        call.out,
        call.arm,
        call.set,
        call.jobs,
        call.limit,
        vision=None if call.vision is None else call.vision == "on",
        fresh=call.fresh,
        cluster=call.dask,
    )
    print(summary(results))
    print(f"written to {call.out}")
    return 0 if all(run["success"] for run in results["runs"]) else 1


def _press(call: argparse.Namespace) -> int:
    from surefoot.config.deployment import load_deployment
    from surefoot.tools.evaluation.label_map import check_drawing, draw, press_terrain

    check_drawing(call.out)
    seed = [] if call.seed is None else [f"hw.seed={call.seed}"]
    scenario = _deployment_file(call.scenario)
    deployment = load_deployment(scenario, [*call.set, *seed])
    label = press_terrain(deployment, call.force, call.step)
    title = f"{scenario.stem}, seed {deployment.hw.seed}: pressed with {call.force:g} N"
    draw(label, title, call.out)
    share = 100.0 * label.collapsible.mean()
    print(f"{share:.0f} % of the points give way; drawn to {call.out}, figures in {call.out.with_suffix('.csv')}")
    return 0


def _reproduce(call: argparse.Namespace) -> int:
    import shlex

    from rich.console import Console

    from surefoot.config.reproduce import Reproduce
    from surefoot.config.typed_toml import build, with_override
    from surefoot.tools.reproduce.experiment import Plan
    from surefoot.tools.reproduce.reproduce import reproduce

    table: dict = {}
    for assignment in call.set:
        table = with_override(table, assignment)
    seeds = tuple(_seeds(call.seeds)) if call.seeds else ()
    console = Console(soft_wrap=True, highlight=False)
    words = ["surefoot", "reproduce", str(call.out), *(["--quick"] if call.quick else [])]
    words += [
        *(["--seeds", call.seeds] if call.seeds else []),
        *(word for each in call.set for word in ("--set", each)),
    ]

    def say(line: str) -> None:
        console.print(line, markup=False)

    plan = Plan(build(Reproduce, table), seeds, call.quick)
    try:
        reproduce(call.out, plan, call.jobs, say, shlex.join(words))
    except KeyboardInterrupt:
        say("stopped; the same call goes on from here")
        raise
    return 0


def _run(call: argparse.Namespace) -> int:
    from surefoot.tools.live_run import live_run

    return live_run(_deployment_file(call.config), call.set, call.seconds, call.plain)


def _child(call: argparse.Namespace) -> int:
    from surefoot.bus.topics import PROCESSES
    from surefoot.components.clock_master import ClockMaster
    from surefoot.components.runner import HubRunner, Runner
    from surefoot.config.deployment import load_deployment

    deployment = load_deployment(_deployment_file(call.config), call.set)
    if call.name not in PROCESSES:
        raise CallError(f"no process {call.name!r}; there are {', '.join(PROCESSES)}")
    if call.name != "io":
        return Runner(deployment, call.name, call.boot, call.parent).run()
    if deployment.run.clock == "simulated":
        return ClockMaster(deployment, call.boot, call.parent).run()
    return HubRunner(deployment, "io", call.boot, call.parent).run()


def _command(call: argparse.Namespace) -> int:
    from surefoot.components.clock_messages import REQUEST
    from surefoot.components.fsm.fsm import COMMANDS

    if call.command not in COMMANDS:
        raise CallError(f"unknown command {call.command!r}; there are {', '.join(COMMANDS)}")
    _say_on_bus(call.namespace, REQUEST, call.command)
    return 0


def _restart(call: argparse.Namespace) -> int:
    from surefoot.bus.topics import PROCESSES
    from surefoot.tools.supervisor import REQUEST

    if call.name not in PROCESSES or call.name == "io":
        names = ", ".join(name for name in PROCESSES if name != "io")
        raise CallError(f"cannot restart {call.name!r}; processes that can be: {names} (io holds robot and bus)")
    _say_on_bus(call.namespace, REQUEST, f"restart {call.name}")
    return 0


def _say_on_bus(namespace: str, key: str, text: str) -> None:
    import time

    from surefoot.bus.session import Session, socket_path

    session = Session(namespace, connect_ms=2000)
    session.put(key, text.encode())
    time.sleep(0.3)  # let it leave before the session closes
    session.close()
    print(f"told {socket_path(namespace)}: {text}")


def _status(call: argparse.Namespace) -> int:
    import time

    from rich.console import Console

    from surefoot.bus.codec import decode
    from surefoot.bus.messages import ProcessStatus
    from surefoot.bus.session import Session, socket_path
    from surefoot.tools.picture import Picture
    from surefoot.tools.status_screen import health, process_table

    session = Session(call.namespace, connect_ms=2000)
    picture = Picture()
    session.subscribe("status/*", lambda key, payload: picture.note_status(decode(ProcessStatus, payload)))
    time.sleep(_LISTEN_S)
    session.close()
    console = Console()
    console.print(f"connected to {socket_path(call.namespace)}", process_table(picture), health(picture), sep="\n")
    silent = [name for name, watched in picture.processes.items() if watched.status is None]
    if silent:
        print(f"silent for {_LISTEN_S} s: {', '.join(silent)}; are they running?")
    return 1 if silent else 0


def _bench(call: argparse.Namespace) -> int:
    from surefoot.tools.bench import bench

    bench()
    return 0


def _topics(call: argparse.Namespace) -> int:
    from surefoot.bus.topics import TOPICS

    print(f"{'key':22s} {'message':18s} {'writer':14s} {'rate Hz':>8s} {'stale s':>8s}")
    for topic in TOPICS.values():
        rate = f"{topic.rate_hz:g}" if topic.rate_hz else "event"
        stale = f"{topic.stale_after_s:g}" if topic.stale_after_s else "-"
        print(f"{topic.key:22s} {topic.message.__name__:18s} {topic.writer:14s} {rate:>8s} {stale:>8s}")
    return 0


def _deployment_file(name: str) -> Path:
    """A path as given, or a deployment that comes with the project."""
    own = Path(__file__).resolve().parent.parent / "config" / f"{name}.toml"
    path = Path(name)
    if path.is_file() or not own.is_file():
        return path
    return own


def _seeds(text: str) -> list[int]:
    try:
        if ":" in text:
            first, _, end = text.partition(":")
            return list(range(int(first), int(end)))
        return [int(each) for each in text.split(",")]
    except ValueError:
        raise CallError(f"--seeds {text!r}: want first:end such as 0:10, or a list such as 0,3,7") from None


if __name__ == "__main__":
    sys.exit(main())
