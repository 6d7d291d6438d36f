"""Why a robot is said not to answer."""

from __future__ import annotations

from surefoot.config.aliengo import Aliengo
from surefoot.hw.aliengo.link_statistics import LinkStatistics


def complaint(settings: Aliengo, found: LinkStatistics, age_s: float | None) -> str:
    """What was measured, the limit and what to look at.

    Args:
        settings: of the link.
        found: how the exchange went.
        age_s: of the newest state; None when there is none.
    """
    where = _where(settings)
    if age_s is None:
        what = f"{where} has sent no good state in {settings.first_answer_s:g} s and {found.commands} commands"
    else:
        limit_ms = 1e3 * settings.stale_s
        what = f"the newest state of {where} is {1e3 * age_s:.0f} ms old by its tick, limit {limit_ms:.0f} ms"
    return f"{what} ({_seen(found)}): is it on, in low-level mode, its tick moving, and the cable in?"


def no_answer(settings: Aliengo, found: LinkStatistics) -> str:
    """The same of an emulator that was to wait for each command, and is not there."""
    return (
        f"{_where(settings)} has not answered within {settings.first_answer_s:g} s ({_seen(found)}): is an "
        "emulator on there, with emulator.pace = packets?"
    )


def _where(settings: Aliengo) -> str:
    return f"{settings.address}:{settings.port}"


def _seen(found: LinkStatistics) -> str:
    trouble = f"; {found.trouble}" if found.trouble else ""
    return (
        f"{found.states} states, {found.duplicates} repeats, {found.old} old ticks, {found.checksum_errors} "
        f"checksum errors, {found.refused} refused, {found.socket_errors} socket errors{trouble}"
    )
