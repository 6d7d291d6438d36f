"""The page of everything on the bus: processes, topics, the fields of every message."""

from __future__ import annotations

from enum import Enum

from surefoot.bus import messages
from surefoot.bus.message import FieldSpec, Message, specs
from surefoot.bus.topics import PROCESSES, TOPICS, Process, Topic, nominal_hz
from surefoot.components.registry import component_class
from surefoot.tools.reference.markdown import code, sentence, table
from surefoot.tools.reference.notes import members, summary

_STATUS = "status/"


def topics_page() -> str:
    """Markdown: who steps when, who writes what and who reads it, and what is in it."""
    readers = _readers()
    shown = {topic.key: topic for topic in TOPICS.values() if not topic.key.startswith(_STATUS)}
    rows = [_topic_cells(topic, readers.get(key, [])) for key, topic in shown.items()]
    any_status = next(topic for topic in TOPICS.values() if topic.key.startswith(_STATUS))
    rows.append((code(f"{_STATUS}NAME"), *_topic_cells(any_status, [])[1:2], "each", "", *_times(any_status)))
    enumerations = [each for each in vars(messages).values() if _is_own_enumeration(each)]
    kinds = dict.fromkeys(topic.message for topic in TOPICS.values())
    return "\n\n".join(
        [
            "## Processes",
            table(("process", "steps", "Hz", "budget ms"), map(_process_cells, PROCESSES.values())),
            "## Topics",
            table(("topic", "message", "writer", "readers", "Hz", "stale after s"), rows),
            "## In every message",
            _fields(Message),
            "## Messages",
            *(f"### `{kind.__name__}`\n\n{summary(kind)}\n\n{_fields(kind)}" for kind in kinds),
            "## Enumerations",
            *(f"### `{each.__name__}`\n\n{summary(each)}\n\n{_values(each)}" for each in enumerations),
        ]
    )


def _readers() -> dict[str, list[str]]:
    """The components that read each topic."""
    found: dict[str, list[str]] = {}
    for name in PROCESSES:
        for key in component_class(name).inputs:
            found.setdefault(key, []).append(name)
    return found


def _process_cells(process: Process) -> tuple[str, ...]:
    when = "by a timer"
    if process.trigger:
        each = "each" if process.every == 1 else f"every {process.every}nd"
        when = f"on {each} `{process.trigger}`"
    hz = nominal_hz(process)
    return code(process.name), when, f"{hz:g}" if hz else "", f"{1e3 * process.budget_s:g}"


def _topic_cells(topic: Topic, readers: list[str]) -> tuple[str, ...]:
    kind = topic.message.__name__
    link = f"[`{kind}`](#{kind.lower()})"
    return code(topic.key), link, topic.writer, ", ".join(readers), *_times(topic)


def _times(topic: Topic) -> tuple[str, str]:
    rate = f"{topic.rate_hz:g}" if topic.rate_hz else "on events"
    return rate, f"{topic.stale_after_s:g}" if topic.stale_after_s else ""


def _fields(kind: type[Message]) -> str:
    common = set(specs(Message)) if kind is not Message else set()
    rows = [
        (code(name), _form(spec), spec.unit, sentence(spec.doc))
        for name, spec in specs(kind).items()
        if name not in common
    ]
    return table(("field", "form", "unit", "what it is"), rows)


def _form(spec: FieldSpec) -> str:
    if spec.kind != "array":
        return spec.kind
    kind = "" if spec.dtype == "float64" else f" {spec.dtype}"
    return " × ".join("any" if n < 0 else str(n) for n in spec.shape) + kind


def _is_own_enumeration(each: object) -> bool:
    return isinstance(each, type) and issubclass(each, Enum) and each.__module__ == messages.__name__


def _values(kind: type[Enum]) -> str:
    told = members(kind)
    return table(("value", "name", "what it is"), ((str(m.value), code(m.name), told[m.name]) for m in kind))
