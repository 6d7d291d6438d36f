"""The one screen of `surefoot drive`: what the robot is at, what was answered, what became of each foothold."""

from __future__ import annotations

from collections.abc import Sequence

from rich.console import Group, RenderableType
from rich.panel import Panel
from rich.table import Table
from rich.text import Text

from surefoot.components.fsm.words import Answer
from surefoot.config.robot import LEGS
from surefoot.tools.diagnosis import why_nothing_moves
from surefoot.tools.picture import Picture
from surefoot.tools.status_screen import machine
from surefoot.tools.teleop.candidates import Candidate, Candidates, Turn
from surefoot.tools.teleop.keys import KEYS, LEAVE, SURE

_ANSWERS = 3

Said = tuple[str, Answer | None]
"""A command, and what came back; None while nothing has."""


def drive_screen(
    picture: Picture,
    candidates: Candidates,
    alternatives: int | None,
    said: Sequence[Said],
    title: str,
    question: str = "",
) -> Group:
    """A rich renderable; fits 80 columns and 30 lines.

    Args:
        picture: what has been heard of the run.
        candidates: of the leg under way, and of the last that found no foothold.
        alternatives: to a planned foothold, in this deployment; None if that is not known.
        said: commands and their answers, newest last.
        title: of the screen.
        question: waits for a key; empty when there is none.
    """
    parts: list[RenderableType] = [machine(picture, alternatives, title)]
    given_up, turn = candidates.given_up, candidates.turn
    if turn is not None and turn is not given_up:
        state = "" if not turn.end else f", {turn.end}"
        parts.append(_table(turn, alternatives, f"{LEGS[turn.leg]}{state}"))
    if given_up is not None:
        parts.append(_table(given_up, alternatives, f"{LEGS[given_up.leg]} has given up: {given_up.end}"))
    parts.append(_answers(said))
    if why := why_nothing_moves(picture):
        parts.append(Text(f"Why nothing moves: {why}.", style="bold yellow"))
    parts.append(Text(question, style="bold red") if question else _help())
    return Group(*parts)


def _table(turn: Turn, alternatives: int | None, title: str) -> Panel:
    table = Table(expand=True, box=None, padding=(0, 1, 0, 0), header_style="dim")
    table.add_column("foothold", no_wrap=True)
    table.add_column("held/asked N", justify="right", no_wrap=True)
    table.add_column("moved mm", justify="right", no_wrap=True)
    table.add_column("verdict", ratio=1, no_wrap=True, overflow="ellipsis")
    for each in turn.candidates:
        forces = f"{each.held_n:.0f}/{each.asked_n:.0f}" if each.asked_n or each.held_n else "-"
        table.add_row(_name(each, alternatives), forces, f"{1e3 * each.displacement_m:.0f}", _verdict(each, turn))
    return Panel(table, title=Text(title, overflow="ellipsis", no_wrap=True), title_align="left")


def _name(candidate: Candidate, alternatives: int | None) -> str:
    of = "" if alternatives is None else f" of {alternatives}"
    return f"alternative {candidate.number}{of}" if candidate.number else "planned"


def _verdict(candidate: Candidate, turn: Turn) -> Text:
    if candidate.verdict:
        return Text(candidate.verdict, style="green" if candidate.accepted else "red")
    return Text("" if turn.end else "under way", style="dim")


def _answers(said: Sequence[Said]) -> Panel:
    lines = [_line(words, answer) for words, answer in said[-_ANSWERS:]]
    return Panel(Text("\n").join(lines) if lines else Text("-"), title="answered", title_align="left")


def _line(words: str, answer: Answer | None) -> Text:
    if answer is None:
        return Text(f"{words} ...", style="dim")
    if answer.taken:
        return Text(f"{words}: {answer.words}", style="green")
    return Text(f"refused  {answer.words}", style="yellow")


def _help() -> Text:
    keys = [f"{'space' if key == ' ' else key} {each.label}" for key, each in KEYS.items()]
    return Text(f"arrows or {' · '.join(keys)} · {LEAVE} leave", style="dim")


SURE_TO_CUT = f"CUT takes the torque away, the robot falls where it is. {SURE}: cut; any other key: no"
