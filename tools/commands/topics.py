"""`surefoot topics`: what is on the bus."""

from __future__ import annotations

import argparse
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from surefoot.bus.topics import Topic

_TOPICS = """\
List what is on the bus: of each topic its message, the process that writes it, how often, and the age from which
on nobody may act on it. What is in a message stands in the documentation, under Topics and messages.

exit code: 0 listed; 2 the call was wrong
"""


def add(commands: argparse._SubParsersAction) -> None:
    """Add the command to the parser."""
    parser = commands.add_parser(
        "topics",
        help="list every topic, its type, writer and rate",
        formatter_class=argparse.RawDescriptionHelpFormatter,
        description=_TOPICS,
        epilog="examples: surefoot topics\n          surefoot topics --json | jq '.\"hw/state\".rate_hz'",
    )
    parser.add_argument("--json", action="store_true", help="for a script")
    parser.set_defaults(run=_run)


def _run(call: argparse.Namespace) -> int:
    import json

    from surefoot.bus.topics import TOPICS

    if call.json:
        print(json.dumps({topic.key: _row(topic) for topic in TOPICS.values()}, indent=1))
        return 0
    print(f"{'key':22s} {'message':18s} {'writer':14s} {'rate Hz':>8s} {'stale s':>8s}")
    for topic in TOPICS.values():
        rate = f"{topic.rate_hz:g}" if topic.rate_hz else "event"
        stale = f"{topic.stale_after_s:g}" if topic.stale_after_s else "-"
        print(f"{topic.key:22s} {topic.message.__name__:18s} {topic.writer:14s} {rate:>8s} {stale:>8s}")
    return 0


def _row(topic: Topic) -> dict[str, Any]:
    """One topic, for a script; null where a rate or an age means nothing."""
    return {
        "message": topic.message.__name__,
        "writer": topic.writer,
        "rate_hz": topic.rate_hz or None,
        "stale_after_s": topic.stale_after_s or None,
    }
