"""The states of Fig. 6."""

from __future__ import annotations

from enum import StrEnum


class State(StrEnum):
    """What the probing cycle is at."""

    PRE_OPT = "PRE_OPT"
    SEND = "SEND"
    OPT = "OPT"
    MOVE = "MOVE"
    DETECT_CONTACT = "DETECT_CONTACT"
    PROBE = "PROBE"
    PROBE_AROUND = "PROBE_AROUND"
    LEG_UP = "LEG_UP"
    RETURN_SAFE = "RETURN_SAFE"
    STOPPED = "STOPPED"
