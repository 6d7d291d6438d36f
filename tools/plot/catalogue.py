"""All that can be drawn of a recording, by the name of `surefoot plot --what`."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

from surefoot.bus.errors import RecordingError
from surefoot.tools.plot.choice import Choice
from surefoot.tools.plot.estimator import estimator
from surefoot.tools.plot.force_displacement import displacement
from surefoot.tools.plot.force_tracking import forces, probing
from surefoot.tools.plot.path_map import path
from surefoot.tools.plot.support import support
from surefoot.tools.plot.time_line import time_line
from surefoot.tools.plot.timing import timing
from surefoot.tools.reproduce.plots import Figure, styled
from surefoot.tools.tables.recording_tables import RecordingTables


@dataclass(frozen=True)
class Drawing:
    """One kind of picture.

    Attributes:
        title: of the page that holds it.
        draw: makes it; raises `NotRecorded` where the recording does not hold what it needs.
    """

    title: str
    draw: Callable[[RecordingTables, Choice], Figure]


DRAWINGS = {
    "probing": Drawing("One probe: forces, support polygon, margin, displacement", probing),
    "forces": Drawing("Forces while a foot probes: asked, planned, estimated, true", forces),
    "displacement": Drawing("Force against displacement of the probing foot", displacement),
    "support": Drawing("Support margin over the run", support),
    "states": Drawing("States and verdicts over the run", time_line),
    "path": Drawing("The way and its footholds, from above", path),
    "estimator": Drawing("Estimate against truth", estimator),
    "timing": Drawing("Step times of the processes", timing),
}
"""By name, as in the help."""


def draw(recording: RecordingTables, what: str, choice: Choice) -> Figure:
    """Draw one of them.

    Raises:
        RecordingError: there is no such drawing; the message lists those there are.
        NotRecorded: the recording does not hold what it needs.
    """
    if what not in DRAWINGS:
        raise RecordingError(f"--what {what}: no such picture; there are {', '.join(DRAWINGS)}")
    with styled():
        return DRAWINGS[what].draw(recording, choice)
