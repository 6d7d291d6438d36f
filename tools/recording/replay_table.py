"""How the result of a replay is shown."""

from __future__ import annotations

from importlib.metadata import version
from pathlib import Path

from rich.console import RenderableType
from rich.table import Table

from surefoot.bus.recording.reader import Recording
from surefoot.tools.evaluation.source import source_digest
from surefoot.tools.recording.replay import ReplayResult


def table(path: Path, result: ReplayResult, diff: bool) -> list[RenderableType]:
    """Counts for each topic; with `diff` where it differs first."""
    topics = Table("topic", "compared", "differ", "missing", "extra", box=None)
    for key, topic in result.comparison.topics.items():
        counts = topic.differing, topic.missing, topic.extra
        topics.add_row(key, str(topic.compared), *(str(count or "-") for count in counts))
    lines: list[RenderableType] = [_versions(path), topics]
    if diff:
        lines += [f"{key}: {topic.first}" for key, topic in result.comparison.topics.items() if topic.first]
    lines += result.notes
    lines += [
        f"{name}: {count} of {count + result.steps[name]} steps left out"
        for name, count in result.left_out.items()
        if count
    ]
    return [*lines, "equal" if result.comparison.equal else "different"]


def _versions(path: Path) -> str:
    about = Recording(path).about
    recorded = f"{about.get('version', '?')} ({about.get('source', '?')})"
    return f"recorded with {recorded}, replayed with {version('surefoot')} ({source_digest()})"
