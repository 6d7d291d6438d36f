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
    where = f"{settings.address}:{settings.port}"
    if age_s is None:
        what = f"{where} has sent no good state in {settings.first_answer_s:g} s and {found.commands} commands"
    else:
        limit_ms = 1e3 * settings.stale_s
        what = f"the newest state of {where} is {1e3 * age_s:.0f} ms old by its tick, limit {limit_ms:.0f} ms"
    seen = (
        f"{found.states} states, {found.duplicates} repeats, {found.old} old ticks, {found.checksum_errors} "
        f"checksum errors, {found.refused} refused, {found.socket_errors} socket errors"
    )
    trouble = f"; {found.trouble}" if found.trouble else ""
    return f"{what} ({seen}{trouble}): is it on, in low-level mode, its tick moving, and the cable in?"
