"""What a check has found, and how bad that is."""

from __future__ import annotations

from dataclasses import dataclass
from enum import StrEnum


class Level(StrEnum):
    """How bad."""

    OK = "ok"
    WARN = "warn"
    FAIL = "fail"
    NOT_HERE = "n/a"
    """The check does not apply to this deployment, or could not be made."""


@dataclass(frozen=True)
class Finding:
    """The outcome of one check, in words for one line.

    Attributes:
        check: its name.
        level: how bad it is.
        found: with its unit.
        expected: and what would be well.
        remedy: what to do; empty where all is well.
    """

    check: str
    level: Level
    found: str
    expected: str = ""
    remedy: str = ""


def well(check: str, found: str, expected: str = "") -> Finding:
    """Nothing is amiss."""
    return Finding(check, Level.OK, found, expected)


def does_not_apply(check: str, why: str) -> Finding:
    """There is nothing to look at."""
    return Finding(check, Level.NOT_HERE, why)


def graded(check: str, value: float, limits: tuple[float, float], words: tuple[str, str, str]) -> Finding:
    """Judge a figure that is better the smaller it is.

    Args:
        check: its name.
        value: the figure.
        limits: above the first it is a warning, above the second a failure.
        words: what was found, what was expected, what to do if it is too large.
    """
    found, expected, remedy = words
    if value <= limits[0]:
        return well(check, found, expected)
    return Finding(check, Level.FAIL if value > limits[1] else Level.WARN, found, expected, remedy)


Findings = dict[str, list[Finding]]
"""By the name of their group, in the order in which they are told."""


def failures(findings: Findings) -> list[Finding]:
    """Those that keep the robot from being started."""
    return [finding for group in findings.values() for finding in group if finding.level is Level.FAIL]
