"""The colours of what comes of a probe and of the states of the machine, the same in every picture."""

from __future__ import annotations

COLORS = {
    "accepted": "#1c7a3c",
    "collapse": "#c81e1e",
    "rejected": "#e8850c",
    "broken off": "#8a5a00",
    "unfinished": "#777777",
}
"""By verdict."""

MARKS = {"accepted": "o", "collapse": "X", "rejected": "^", "broken off": "s", "unfinished": "o"}
"""By verdict: told apart without colours too."""

STATES = {
    "DAMP": "#9aa1a9",
    "HOLD": "#9aa1a9",
    "STAND_UP": "#b7bec6",
    "SIT_DOWN": "#b7bec6",
    "STAND": "#d5d9de",
    "PRE_OPT": "#c9b8e8",
    "SEND": "#b39ddb",
    "OPT": "#8e6fc9",
    "MOVE": "#7fb0e8",
    "DETECT_CONTACT": "#3f83d0",
    "PROBE": "#e8850c",
    "PROBE_AROUND": "#f3bf7d",
    "LEG_UP": "#c81e1e",
    "RETURN_SAFE": "#e07a7a",
    "STOPPED": "#5c6570",
}
"""By state of Fig. 6, or posture."""

OTHER_STATE = "#2a9d8f"
"""Of a state that is not among them."""
