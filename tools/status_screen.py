"""The one-screen status of a run, in words and figures."""

from __future__ import annotations

import time

from rich.console import Group, JustifyMethod, RenderableType
from rich.panel import Panel
from rich.table import Table
from rich.text import Text

from surefoot.bus.message import specs
from surefoot.bus.messages import Plan, ProcessStatus
from surefoot.bus.topics import TOPICS
from surefoot.components.fsm.course import AROUND_POINTS
from surefoot.config.robot import LEGS
from surefoot.tools.picture import Picture
from surefoot.tools.verdict import Verdict

TOLD = ("contact", "collapse", "late_collapse", "accepted", "rejected", "stopped", "refused", "waiting")
"""Kinds of events worth a line."""

_SILENT_S = 3.0
_RATE_BAND = 0.2  # a rate is well within so much of nominal
_EVENTS, _REASONS = 5, 4
_FORCES = specs(Plan)["envelope_W"].shape[0]


def screen(picture: Picture, verdict: Verdict, alternatives: int, title: str) -> Group:
    """A rich renderable of what the supervisor has heard; fits 80 columns and 30 lines.

    Args:
        picture: what has been heard.
        verdict: how the run stands.
        alternatives: to a planned foothold, in this deployment.
        title: of the screen.
    """
    parts: list[RenderableType] = [
        _machine(picture, alternatives, title),
        process_table(picture),
        health(picture),
        _events(picture),
    ]
    if verdict.reason:
        parts.append(Text(f"{verdict.reason}. {verdict.advice}", style="bold red"))
    return Group(*parts)


def event_line(event) -> str:
    """One event in a line."""
    leg = LEGS[event.leg] if event.leg >= 0 else "  "
    return f"{event.t:8.2f} s  {leg}  {event.kind}: {event.reason}"


def _machine(picture: Picture, alternatives: int, title: str) -> Panel:
    reference, estimate = picture.reference, picture.estimate
    if reference is None or estimate is None:
        said = [w.status.reason for w in picture.processes.values() if w.status is not None and w.status.reason]
        return Panel(said[0] if said else "the processes come up", title=title)
    leg, counts = reference.leg, picture.counts
    lines = [f"[bold]{reference.state}[/bold]  {reference.reason}"]
    if leg >= 0:
        number, point = reference.candidate, reference.around
        candidate = f"alternative {number} of {alternatives}" if number else "planned foothold"
        around = f", point {point} of {AROUND_POINTS} around it" if 1 <= point <= AROUND_POINTS else ""
        lines.append(f"leg [bold]{LEGS[leg]}[/bold], {candidate}{around}")
        held = estimate.force_W[leg] @ estimate.normal_W
        asked = "  -"
        if 0 <= reference.force_index < len(reference.probe_force_W) - 1:
            force = reference.probe_force_W[reference.force_index + 1] @ reference.normal_W
            asked = f"{force:3.0f}"
            lines[-1] += f", force {reference.force_index + 1} of {_FORCES}"
        margin = "-" if picture.margin_m is None else f"{1e3 * picture.margin_m:.0f} mm"
        lines.append(f"force asked {asked} N, measured {held:3.0f} N;  support margin {margin}")
    else:
        lines.append("four feet stand")
    lines.append(
        f"t {reference.t:.1f} s, real-time factor {picture.real_time_factor(recent=True):.2f};  "
        f"forward {estimate.p_WB[0]:.2f} m, height {estimate.p_WB[2]:.2f} m"
    )
    lines.append(
        f"footholds accepted {counts['accepted']}, collapses {counts['collapse'] + counts['late_collapse']}, "
        f"out of reach {counts['rejected']}, largest displacement {1e3 * picture.displacement_m:.0f} mm"
    )
    return Panel("\n".join(lines), title=title)


def process_table(picture: Picture) -> Table:
    """Each process's life, rate against nominal, step times, oldest input, and what went wrong how often."""
    table = Table(expand=True, box=None, padding=(0, 1, 0, 0), header_style="dim")
    # Least widths: the input's name gives way first on a narrow terminal.
    widths = {
        "process": 13,
        "state": 5,
        "Hz": 7,
        "p50 ms": 6,
        "p99 ms": 6,
        "oldest input": 12,
        "late": 4,
        "bad": 3,
    }
    for column, width in (widths | {"restarts": 8}).items():
        justify: JustifyMethod = "left" if column in ("process", "state", "oldest input") else "right"
        table.add_column(column, justify=justify, no_wrap=True, overflow="ellipsis", min_width=width)
    for name, watched in picture.processes.items():
        status = watched.status
        restarts = str(watched.restarts)
        name = f"{name}, {watched.host}" if watched.host else name
        if status is None:
            table.add_row(name, "not heard", *[""] * 6, restarts)
            continue
        nominal = status.nominal_hz
        rate = f"{status.rate_hz:.0f}/{nominal:.0f}" if nominal else "on event"
        off = nominal and abs(status.rate_hz / nominal - 1.0) > _RATE_BAND
        table.add_row(
            name,
            Text(status.life, style="bold red" if status.life == "FAILED" else ""),
            Text(rate, style="yellow" if off else ""),
            f"{status.step_p50_ms:.2f}",
            f"{status.step_p99_ms:.2f}",
            _oldest_input(status),
            str(status.overruns),
            str(status.bad_messages),
            restarts,
        )
    return table


def health(picture: Picture) -> Text:
    """In words what is the matter with which process; nothing when all is well."""
    now, lines = time.monotonic(), []
    for name, watched in picture.processes.items():
        if watched.status is None:
            continue
        silent = now - watched.heard
        reason = f"silent for {silent:.0f} s" if silent > _SILENT_S else watched.status.reason
        if reason:
            lines.append(f" {name}: {reason}")
    return Text("\n".join(lines[:_REASONS]), style="yellow", overflow="ellipsis", no_wrap=True)


def _oldest_input(status: ProcessStatus) -> Text:
    """The input that is oldest for what its topic allows, with its age; red when that is too old."""
    ages = [
        (age / TOPICS[key].stale_after_s, key, age)
        for key, age in zip(status.input, status.input_age_s, strict=False)
        if TOPICS[key].stale_after_s and age >= 0.0
    ]
    if not ages:
        return Text("-")
    share, key, age = max(ages)
    return Text(f"{key} {1e3 * age:.0f} ms", style="red" if share > 1.0 else "")


def _events(picture: Picture) -> Panel:
    told = [event_line(event) for event in list(picture.events)[-60:] if event.kind in TOLD]
    lines = told[-_EVENTS:] + [f"supervisor: {note}" for note in picture.notes[-2:]]
    return Panel(Text("\n".join(lines) or "-", overflow="ellipsis", no_wrap=True), title="last events")
