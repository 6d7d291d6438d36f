"""`surefoot topics`: what is on the bus."""

from __future__ import annotations

import argparse


def add(commands: argparse._SubParsersAction) -> None:
    """Add the command to the parser."""
    parser = commands.add_parser("topics", help="list every topic, its type, writer and rate")
    parser.set_defaults(run=_run)


def _run(call: argparse.Namespace) -> int:
    from surefoot.bus.topics import TOPICS

    print(f"{'key':22s} {'message':18s} {'writer':14s} {'rate Hz':>8s} {'stale s':>8s}")
    for topic in TOPICS.values():
        rate = f"{topic.rate_hz:g}" if topic.rate_hz else "event"
        stale = f"{topic.stale_after_s:g}" if topic.stale_after_s else "-"
        print(f"{topic.key:22s} {topic.message.__name__:18s} {topic.writer:14s} {rate:>8s} {stale:>8s}")
    return 0
