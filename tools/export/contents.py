"""What of a recording is exported."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

from surefoot.tools.tables.recording_tables import RecordingTables
from surefoot.tools.tables.table import NotRecorded

BULKY = ("mpc/policy", "hw/depth")
"""Nearly all of a recording's bytes: they are exported when they are asked for by name."""


@dataclass(frozen=True)
class Contents:
    """Topics and a stretch of time.

    Attributes:
        keys: of the topics.
        left_out: topics that are there, and are exported only when they are named.
        begin_s, end_s: of the run's clock.
        scene: the robot in three dimensions is wanted too, where the format has room for it.
    """

    keys: tuple[str, ...]
    left_out: tuple[str, ...]
    begin_s: float
    end_s: float
    scene: bool = False


def contents(
    recording: RecordingTables, wanted: Sequence[str], begin_s: float, end_s: float, bulky: bool = False
) -> Contents:
    """Choose.

    Args:
        recording: that is exported.
        wanted: topics by key; none: all.
        begin_s, end_s: what is exported of the run [s].
        bulky: topics in `BULKY` come without being named.

    Raises:
        NotRecorded: a topic is not in the recording, or nothing of that time.
    """
    for key in wanted:
        if key not in recording:
            recording[key]  # says which there are
    begin, end = recording.span_s
    if begin_s > end or end_s < begin or begin_s > end_s:
        raise NotRecorded(
            f"{recording.path}: nothing from {begin_s:g} to {end_s:g} s; it is of {begin:.3f} to {end:.3f} s"
        )
    left_out = () if bulky or wanted else tuple(key for key in recording if key in BULKY)
    keys = tuple(wanted) or tuple(key for key in recording if key not in left_out)
    scene = not wanted and bool({"sim/truth", "state/estimate"} & set(recording))
    return Contents(keys, left_out, max(begin_s, begin), min(end_s, end), scene)
