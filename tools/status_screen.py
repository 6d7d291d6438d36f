"""The one-screen status of a run, in words and figures."""

from __future__ import annotations

from rich.console import Group, JustifyMethod, RenderableType
from rich.panel import Panel
from rich.table import Table
from rich.text import Text

from surefoot.bus.message import specs
from surefoot.bus.messages import Plan, ProcessStatus
from surefoot.components.fsm.course import AROUND_POINTS
from surefoot.config.robot import LEGS
from surefoot.tools.diagnosis import awaited, troubles, why_nothing_moves, worst_input
from surefoot.tools.picture import RATE_BAND, Picture, Watched

TOLD = ("contact", "collapse", "late_collapse", "accepted", "rejected", "stopped", "refused", "waiting")
"""Kinds of events worth a line."""

_EVENTS, _REASONS, _WHY_LINES = 5, 4, 2
_COLUMNS: tuple[tuple[str, int, JustifyMethod], ...] = (
    ("process", 13, "left"),
    ("state", 5, "left"),
    ("Hz", 7, "right"),
    ("p50 ms", 6, "right"),
    ("p99", 4, "right"),
    ("max", 4, "right"),
    ("late", 4, "right"),
    ("bad", 3, "right"),
    ("worst input ms", 12, "left"),
    ("boot", 4, "right"),
)
_FORCES = specs(Plan)["envelope_W"].shape[0]


def screen(picture: Picture, alternatives: int | None, title: str, closing: str = "") -> Group:
    """A rich renderable of a run; fits 80 columns and 30 lines.

    Args:
        picture: what has been heard.
        alternatives: to a planned foothold, in this deployment; None if that is not known.
        title: of the screen.
        closing: how the run stands, in words; empty when there is nothing to say.
    """
    why, well = why_nothing_moves(picture), health(picture)
    parts: list[RenderableType] = [machine(picture, alternatives, title), process_table(picture)]
    if well.plain:
        parts.append(well)
    if picture.tuned:
        parts.append(Text(f" tuned: {', '.join(picture.tuned)}", style="cyan", overflow="ellipsis", no_wrap=True))
    parts.append(_events(picture, _EVENTS - _WHY_LINES if why else _EVENTS))
    if why:
        parts.append(Text(f"Why nothing moves: {why}.", style="bold yellow"))
    if closing:
        parts.append(Text(closing, style="bold red"))
    return Group(*parts)


def event_line(event) -> str:
    """One event in a line."""
    leg = LEGS[event.leg] if event.leg >= 0 else "  "
    return f"{event.t:8.2f} s  {leg}  {event.kind}: {event.reason}"


def machine(picture: Picture, alternatives: int | None, title: str) -> Panel:
    """What the state machine is at: its state and why, the leg, its candidate, the force, the margin."""
    reference, estimate = picture.reference, picture.estimate
    if reference is None or estimate is None:
        io = picture.processes["io"].status
        words = f"time stands at {io.t:.2f} s" if io is not None and io.steps else "the processes come up"
        return Panel(words, title=title)
    leg, counts = reference.leg, picture.counts
    lines = [f"[bold]{reference.state}[/bold]  {reference.reason}"]
    if leg >= 0:
        number, point = reference.candidate, reference.around
        of = "" if alternatives is None else f" of {alternatives}"
        candidate = f"alternative {number}{of}" if number else "planned foothold"
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
    """Each process's life, rate against nominal, step times, worst input, and what went wrong how often.

    The worst input is the one that is oldest for what its topic allows, with its age and that limit.
    """
    table = Table(expand=True, box=None, padding=(0, 1, 0, 0), header_style="dim")
    # Least widths: the input's name gives way first on a narrow terminal.
    for column, width, justify in _COLUMNS:
        table.add_column(column, justify=justify, no_wrap=True, overflow="ellipsis", min_width=width)
    still = awaited(picture) != ""
    for name, watched in picture.processes.items():
        status = watched.status
        boot = str(max(watched.restarts, status.boot if status is not None else 0))
        name = f"{name}, {watched.host}" if watched.host else name
        if status is None or watched.out:
            state = "out" if watched.out else "lent" if watched.lent_to else "absent"
            table.add_row(name, Text(state, style="yellow"), *[""] * 7, boot)
            continue
        table.add_row(
            name,
            _state(watched, status),
            _rate(status, still),
            _ms(status.step_p50_ms),
            _ms(status.step_p99_ms),
            _ms(status.step_max_ms),
            str(status.overruns),
            str(status.bad_messages),
            _worst_input(status),
            boot,
        )
    return table


def health(picture: Picture) -> Text:
    """In words what is the matter with which process, and which is lent; nothing when all is well."""
    wrong = troubles(picture)
    lines = [f" {name}: {words}" for name, words in wrong.items()]
    lines += [
        f" {name}: lent to process {watched.lent_to}"
        for name, watched in picture.processes.items()
        if watched.lent_to and name not in wrong
    ]
    if len(lines) > _REASONS:
        lines[_REASONS - 1 :] = [f" and {len(lines) - _REASONS + 1} more"]
    return Text("\n".join(lines), style="yellow", overflow="ellipsis", no_wrap=True)


def _state(watched: Watched, status: ProcessStatus) -> Text:
    if watched.lent_to:
        return Text("lent", style="cyan")
    return Text(status.life, style="bold red" if status.life == "FAILED" else "")


def _rate(status: ProcessStatus, still: bool) -> Text:
    if not status.nominal_hz:
        return Text("event")
    off = not still and abs(status.rate_hz / status.nominal_hz - 1.0) > RATE_BAND
    return Text(f"{status.rate_hz:.0f}/{status.nominal_hz:.0f}", style="yellow" if off else "")


def _ms(value: float) -> str:
    """Four characters tell a step's time, from hundredths of a millisecond to seconds."""
    return f"{value:.2f}" if value < 10.0 else f"{value:.1f}" if value < 100.0 else f"{value:.0f}"


def _worst_input(status: ProcessStatus) -> Text:
    worst = worst_input(status)
    if worst is None:
        return Text("-")
    key, age, limit = worst
    return Text(f"{key} {1e3 * age:.0f}/{1e3 * limit:.0f}", style="red" if age > limit else "")


def _events(picture: Picture, most: int) -> Panel:
    told = [event_line(event) for event in list(picture.events)[-60:] if event.kind in TOLD]
    lines = told[-most:] + [f"supervisor: {note}" for note in picture.notes[-2:]]
    return Panel(Text("\n".join(lines) or "-", overflow="ellipsis", no_wrap=True), title="last events")
