"""The probes of a run as a table to read."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from surefoot.config.robot import LEGS
from surefoot.tools.document import Table
from surefoot.tools.plot.probes import Probe

HEAD = (
    "probe", "time s", "leg", "candidate", "where m", "presses", "held N", "moved mm", "verdict", "certified N",
    "in the machine's words",
)  # fmt: skip

_UNBROKEN = "\u00a0"
"""A space at which no line ends."""


def probe_table(probes: Sequence[Probe]) -> Table:
    """One row a candidate that a foot was set on."""
    caption = (
        "Held: the largest normal force that was held, at the foothold or around it. Moved: the foot's largest "
        "displacement from its contact. Certified: what the foothold is trusted with from then on."
    )
    return Table(caption, HEAD, [_row(probe) for probe in probes])


def _row(probe: Probe) -> list[str]:
    x, y, _ = probe.p_WF.tolist()
    where = f"{x:.2f},{_UNBROKEN}{y:.2f}" if np.isfinite(x) else "–"
    return [
        str(probe.number),
        f"{probe.begin_t:.1f}",
        LEGS[probe.leg],
        probe.where.replace(" ", _UNBROKEN),
        where,
        str(len(probe.presses)),
        f"{probe.held_n:.0f}" if probe.held_n else "–",
        f"{1e3 * probe.displacement_m:.0f}",
        probe.verdict,
        f"{probe.certified_n:.0f}" if probe.certified_n else "–",
        probe.reason,
    ]
