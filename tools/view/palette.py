"""The view's colours and scales, each said once; the legend is made of them."""

from __future__ import annotations

from enum import StrEnum

import numpy as np

from surefoot.bus.messages import LegStatus
from surefoot.tools.view.drawing import Rgb

FORCE_M_PER_N = 0.002
"""Length of a force's arrow: 100 N are 20 cm."""

CONE_M = 0.08
"""Height at which a friction cone is drawn."""

HELD_FULL_N = 150.0
"""A load that has held is the greener the larger it is, up to this."""


class Verdict(StrEnum):
    """What is known of a place on the ground."""

    UNTESTED = "untested"
    PROBING = "probing"
    HELD = "held"
    COLLAPSED = "collapsed"
    REJECTED = "rejected"
    """A candidate that was given up before a foot stood on it."""


VERDICT_RGB: dict[Verdict, Rgb] = {
    Verdict.UNTESTED: (150, 150, 155),
    Verdict.PROBING: (255, 176, 0),
    Verdict.HELD: (30, 160, 70),
    Verdict.COLLAPSED: (215, 40, 40),
    Verdict.REJECTED: (150, 90, 170),
}
_HELD_LEAST = np.array([190, 230, 170])  # of a load of hardly anything

LEG_RGB: dict[LegStatus, Rgb] = {
    LegStatus.STANCE: (35, 38, 42),
    LegStatus.SWING: (60, 150, 240),
    LegStatus.LANDING: (0, 190, 200),
    LegStatus.PROBING: VERDICT_RGB[Verdict.PROBING],
    LegStatus.COLLAPSING: VERDICT_RGB[Verdict.COLLAPSED],
}

MEASURED: Rgb = (20, 110, 220)
ASKED: Rgb = (240, 120, 20)
ENVELOPE: Rgb = (160, 60, 200)
CONE: Rgb = (120, 170, 255)
SUPPORT: Rgb = (70, 160, 90)
MARGIN: Rgb = (225, 165, 40)
COM: Rgb = (220, 30, 90)
SWING: Rgb = (60, 150, 240)
HORIZON_BASE: Rgb = (200, 60, 120)
HORIZON_FOOT: Rgb = (130, 130, 240)
CANDIDATE: Rgb = (0, 150, 170)
_LOW, _HIGH = np.array([80, 60, 130]), np.array([60, 160, 185])  # of the map's heights


def candidate_rgb(verdict: Verdict) -> Rgb:
    """Of a candidate: one that was not tried yet has a colour of its own."""
    return CANDIDATE if verdict == Verdict.UNTESTED else VERDICT_RGB[verdict]


def held_rgb(held_n: np.ndarray) -> np.ndarray:
    """(n, 3) colours of loads that have held (n,) [N]."""
    share = np.clip(np.asarray(held_n) / HELD_FULL_N, 0.0, 1.0)[:, None]
    return (_HELD_LEAST + share * (np.array(VERDICT_RGB[Verdict.HELD]) - _HELD_LEAST)).astype(np.uint8)


def height_rgb(height_m: np.ndarray) -> np.ndarray:
    """(n, 3) colours of heights (n,) [m] between the lowest and the highest of them."""
    low, high = (float(height_m.min()), float(height_m.max())) if len(height_m) else (0.0, 0.0)
    share = ((height_m - low) / max(high - low, 0.02))[:, None]
    return (_LOW + share * (_HIGH - _LOW)).astype(np.uint8)


LEGEND: tuple[tuple[Rgb, str], ...] = (
    (VERDICT_RGB[Verdict.UNTESTED], "foothold, untested"),
    (VERDICT_RGB[Verdict.PROBING], "being probed"),
    (VERDICT_RGB[Verdict.HELD], "has held (N beside it)"),
    (VERDICT_RGB[Verdict.COLLAPSED], "gave way"),
    (VERDICT_RGB[Verdict.REJECTED], "candidate given up"),
    (CANDIDATE, "candidate"),
    (MEASURED, "force measured"),
    (ASKED, "force asked"),
    (ENVELOPE, "force envelope of the stride"),
    (CONE, "friction cone"),
    (SUPPORT, "support polygon"),
    (MARGIN, "its margin"),
    (COM, "centre of mass"),
    (SWING, "planned swing; a foot in the air"),
    (HORIZON_BASE, "MPC horizon: base"),
    (HORIZON_FOOT, "MPC horizon: moving foot"),
)
"""Colour and meaning."""
