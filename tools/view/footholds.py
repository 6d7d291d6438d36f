"""Places that feet have tried, with what came of it, and the candidates of the leg's turn."""

from __future__ import annotations

import numpy as np

from surefoot.bus.messages import MotionReference
from surefoot.tools.view.drawing import Drawing, Shapes, Words, level
from surefoot.tools.view.history import History, Spot
from surefoot.tools.view.palette import VERDICT_RGB, Verdict, candidate_rgb, held_rgb

_DISC_M, _AROUND_M, _THICK_M = 0.075, 0.016, 0.003
_CANDIDATE_M = 0.03
_TOLD = 6  # of the newest footholds have their newtons beside them
_SAME_M = 0.03


def draw_footholds(history: History, reference: MotionReference, foot_radius_m: float) -> Drawing:
    """Discs on the ground: large ones for footholds, small ones for the points around them."""
    spots = [*_untested(history, reference), *history.spots]
    discs = _discs([spot for spot in spots if not spot.around], _DISC_M, foot_radius_m)
    around = _discs([spot for spot in spots if spot.around], _AROUND_M, foot_radius_m - _THICK_M)
    drawing: Drawing = {"footholds/discs": discs, "footholds/around": around}
    told = [spot for spot in history.spots if not spot.around and spot.verdict != Verdict.UNTESTED][-_TOLD:]
    for number, spot in enumerate(told):
        drawing[f"footholds/words{number}"] = Words(spot.p_W + [0.0, 0.0, 0.02], _words(spot))
    return drawing


def draw_candidates(history: History, foot_radius_m: float) -> Drawing:
    """The candidates of the leg's turn on which no foot has stood, as posts with their numbers."""
    drawing: Drawing = {}
    open_ones = {
        number: each
        for number, each in history.candidates.items()
        if each.verdict in (Verdict.UNTESTED, Verdict.REJECTED)
    }
    if not open_ones:
        return drawing
    points = np.array([each.p_W for each in open_ones.values()]) - [0.0, 0.0, foot_radius_m]
    rgb = np.array([candidate_rgb(each.verdict) for each in open_ones.values()], np.uint8)
    drawing["candidates/cones"] = level("cone", points, (_CANDIDATE_M, _CANDIDATE_M, 0.06), rgb)
    for number, point in zip(open_ones, points, strict=True):
        drawing[f"candidates/words{number}"] = Words(point + [0.0, 0.0, 0.075], str(number))
    return drawing


def _untested(history: History, reference: MotionReference) -> list[Spot]:
    """Where feet stand that no event has told of: as the robot got up, or before anybody listened."""
    told_W = np.array([spot.p_W for spot in history.spots]).reshape(-1, 1, 3)
    apart_m = np.linalg.norm(told_W - reference.p_WF, axis=2).min(axis=0, initial=np.inf)
    return [
        Spot(leg, reference.p_WF[leg], Verdict.UNTESTED)
        for leg in range(4)
        if leg != reference.leg and apart_m[leg] >= _SAME_M
    ]


def _discs(spots: list[Spot], width_m: float, below_m: float) -> Shapes:
    points = np.array([spot.p_W for spot in spots]).reshape(-1, 3) - [0.0, 0.0, below_m]
    rgb = np.array([VERDICT_RGB[spot.verdict] for spot in spots], np.uint8).reshape(-1, 3)
    held = np.array([spot.verdict == Verdict.HELD for spot in spots], bool)
    rgb[held] = held_rgb(np.array([spot.held_n for spot in spots])[held])
    return level("cylinder", points, (width_m, width_m, 2.0 * _THICK_M), rgb)


def _words(spot: Spot) -> str:
    match spot.verdict:
        case Verdict.HELD:
            return f"held {spot.held_n:.0f} N"
        case Verdict.COLLAPSED:
            return f"gave way, {spot.held_n:.0f} N asked"
        case _:
            return str(spot.verdict)
