"""The one-screen status of a run, in words and figures."""

from __future__ import annotations

import time

from rich.console import Group
from rich.panel import Panel
from rich.table import Table

from surefoot.bus.topics import PROCESSES, TOPICS
from surefoot.config.robot import LEGS
from surefoot.tools.supervisor import Picture

_SILENT_S = 3.0
_TOLD = ("contact", "collapse", "late_collapse", "accepted", "rejected", "stopped", "refused", "waiting")


def screen(picture: Picture) -> Group:
    """A rich renderable of what the supervisor has heard."""
    return Group(_machine(picture), _processes(picture), _events(picture))


def _machine(picture: Picture) -> Panel:
    reference, estimate = picture.reference, picture.estimate
    if reference is None or estimate is None:
        return Panel("waiting for the first messages", title="Surefoot")
    passed = max(time.monotonic() - picture.began, 1e-3)
    leg = reference.leg
    lines = [f"[bold]{reference.state}[/bold]  {reference.reason}"]
    if leg >= 0:
        place = "foothold" if reference.candidate == 0 else f"alternative {reference.candidate}"
        around = f", point {reference.around} around it" if reference.around else ""
        lines.append(f"leg {LEGS[leg]}, {place}{around}")
        held = estimate.force_W[leg] @ estimate.normal_W
        asked = "-"
        if reference.force_index >= 0:
            asked = f"{reference.probe_force_W[reference.force_index + 1] @ reference.normal_W:.0f} N"
        lines.append(f"force {reference.force_index + 1} of 6: asked {asked}, measured {held:.0f} N")
    lines.append(
        f"t {reference.t:.1f} s, real-time factor {reference.t / passed:.2f}, "
        f"base x {estimate.p_WB[0]:.2f} m, z {estimate.p_WB[2]:.2f} m"
    )
    return Panel("\n".join(lines), title="Surefoot")


def _processes(picture: Picture) -> Table:
    table = Table(expand=True)
    for column in (
        "process",
        "state",
        "rate Hz",
        "nominal",
        "p50 ms",
        "p99 ms",
        "overruns",
        "bad",
        "restarts",
        "",
    ):
        table.add_column(column, justify="left" if column in ("process", "state", "") else "right")
    now = time.monotonic()
    for name in PROCESSES:
        watched = picture.processes[name]
        status = watched.status
        if status is None:
            table.add_row(name, "starting", *[""] * 6, str(watched.restarts), "")
            continue
        reason = status.reason
        if now - watched.heard > _SILENT_S:
            reason = f"silent for {now - watched.heard:.0f} s"
        table.add_row(
            name,
            status.life,
            f"{status.rate_hz:.0f}",
            _nominal(name),
            f"{status.step_p50_ms:.2f}",
            f"{status.step_p99_ms:.2f}",
            str(status.overruns),
            str(status.bad_messages),
            str(watched.restarts),
            reason,
        )
    return table


def _nominal(name: str) -> str:
    process = PROCESSES[name]
    rate = process.rate_hz or TOPICS[process.trigger].rate_hz / process.every
    return f"{rate:.0f}" if rate else "event"


def _events(picture: Picture) -> Panel:
    told = [event for event in list(picture.events) if event.kind in _TOLD][-8:]
    lines = [
        f"{event.t:7.1f} s  {LEGS[event.leg] if event.leg >= 0 else '  '}  {event.kind}: {event.reason}"
        for event in told
    ]
    return Panel("\n".join(lines) or "-", title="events")
