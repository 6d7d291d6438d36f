"""How the contents of a recording are shown."""

from __future__ import annotations

from typing import Any

from rich.console import RenderableType
from rich.table import Table

from surefoot.tools.recording.contents import Contents


def table(contents: Contents) -> list[RenderableType]:
    """What a person wants to see of a recording."""
    about = contents.recording.about
    size = contents.recording.path.stat().st_size / 1e6
    made = (
        f"made {about.get('made', '?')} by version {about.get('version', '?')}, sources {about.get('source', '?')}"
    )
    topics = Table("topic", "messages", "missing", "from s", "to s", "per s", "MB", box=None)
    for key, topic in sorted(contents.topics.items()):
        span = topic.last_t - topic.first_t
        rate = f"{(topic.messages - 1) / span:.1f}" if span > 0.0 and topic.messages > 1 else "-"
        figures = f"{topic.first_t:.3f}", f"{topic.last_t:.3f}", rate, f"{topic.bytes / 1e6:.2f}"
        topics.add_row(key, str(topic.messages), str(topic.missing or "-"), *figures)
    processes = Table("process", "steps", "missing", "restarts", "states to begin from", box=None)
    for name, process in sorted(contents.processes.items()):
        processes.add_row(
            name,
            str(process.steps),
            str(process.missing_steps or "-"),
            str(process.restarts or "-"),
            str(process.checkpoints),
        )
    verdict = "\n".join(f"missing: {each}" for each in contents.gaps) or "nothing is missing"
    return [f"{contents.recording.path}, {size:.1f} MB, {made}", "", topics, "", processes, "", verdict]


def as_json(contents: Contents) -> dict[str, Any]:
    """The same for scripts."""
    about = {name: text for name, text in contents.recording.about.items() if name != "config"}
    return about | {
        "topics": {
            key: {
                "messages": topic.messages,
                "missing": topic.missing,
                "first_t": topic.first_t,
                "last_t": topic.last_t,
                "bytes": topic.bytes,
            }
            for key, topic in contents.topics.items()
        },
        "processes": {
            name: {
                "steps": process.steps,
                "missing": process.missing_steps,
                "restarts": process.restarts,
                "checkpoints": process.checkpoints,
            }
            for name, process in contents.processes.items()
        },
        "gaps": contents.gaps,
    }
