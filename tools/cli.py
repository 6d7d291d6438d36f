"""The `surefoot` command."""

from __future__ import annotations

import argparse
import os
import sys
from pathlib import Path

for _name in ("OMP_NUM_THREADS", "OPENBLAS_NUM_THREADS", "MKL_NUM_THREADS"):
    # Before numpy is imported: its threads would fight the control chain for the cores.
    os.environ.setdefault(_name, "1")

from surefoot.config.typed_toml import ConfigError  # noqa: E402


def main(arguments: list[str] | None = None) -> int:
    """Run one command; returns the exit code: 0 done, 1 the run failed, 2 the call was wrong."""
    parser = _parser()
    call = parser.parse_args(arguments)
    try:
        return call.run(call)
    except (ConfigError, ValueError, KeyError) as error:
        print(f"surefoot: {error.args[0] if error.args else error}", file=sys.stderr)
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
    graded.add_argument("scenario", help="a deployment file, or its name in config/ (flat, planks)")
    graded.add_argument("--seeds", default="0:10", help="first:last+1, or a list such as 0,3,7")
    graded.add_argument("--arm", default="full", help="full, mpc_only, no_support_polygon, ... or NAME=FIGURE")
    graded.add_argument("--set", action="append", default=[], metavar="KEY=VALUE", help="override a setting")
    graded.add_argument("--jobs", type=int, default=1, help="runs at the same time")
    graded.add_argument("--limit", type=float, default=1200.0, help="simulated seconds that count as a time-out")
    graded.add_argument("--out", type=Path, required=True, help="folder for results.json and summary.md")
    graded.set_defaults(run=_eval)
    topics = commands.add_parser("topics", help="list every topic, its type, writer and rate")
    topics.set_defaults(run=_topics)
    return parser


def _eval(call: argparse.Namespace) -> int:
    from surefoot.tools.evaluation.evaluate import evaluate, summary

    results = evaluate(
        _deployment_file(call.scenario), _seeds(call.seeds), call.out, call.arm, call.set, call.jobs, call.limit
    )
    print(summary(results))
    print(f"written to {call.out}")
    return 0 if all(run["success"] for run in results["runs"]) else 1


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
        raise ValueError(f"--seeds {text!r}: want first:end such as 0:10, or a list such as 0,3,7") from None


if __name__ == "__main__":
    sys.exit(main())
