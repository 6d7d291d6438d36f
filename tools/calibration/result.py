"""What came out, and the words for it."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from surefoot.config.unit import Unit
from surefoot.tools.calibration.thresholds import Proposal


@dataclass(frozen=True)
class Result:
    """A robot file's content, what else is worth saying, and settings that the figures ask for."""

    unit: Unit
    notes: tuple[str, ...]
    proposals: tuple[Proposal, ...]


def told(result: Result) -> str:
    """For a terminal: all that the robot file holds now, the notes, and the proposals beside present values."""
    unit = result.unit
    lines = [line for part in unit.parts for line in _lines(part, getattr(unit, part))]
    proposals = [
        f"  {each.key:<26}{each.present:8.1f}{each.proposed:10.1f}    {each.why}" for each in result.proposals
    ]
    head = f"  {'':<26}{'present':>8}{'proposed':>10}"
    title = "the least that these figures ask for, for the worst foot; nothing is changed by itself:"
    return "\n".join([*lines, *result.notes, title, head, *proposals])


def _lines(part: str, section: object) -> list[str]:
    units = {
        "gyroscope": {"bias": "rad/s"},
        "accelerometer": {"bias": "m/s^2"},
        "torque": {"offset": "N m", "noise": "N m"},
        "friction": {"coulomb": "N m", "viscous": "N m s/rad"},
        "foot_zero": {"raw": "raw"},
        "foot_scale": {"force": "N to one raw"},
    }
    return [
        f"{part} {name} [{unit}]: "
        + np.array2string(np.array(getattr(section, name)), precision=4, max_line_width=200)
        for name, unit in units[part].items()
    ]
