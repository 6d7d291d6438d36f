"""What the feet stand on, by the status of their legs: (4,) flags for (4,) of `LegStatus`."""

from __future__ import annotations

import numpy as np

from surefoot.bus.messages import LegStatus

# As integers: numpy takes five times as long to compare with a member of an enumeration, and this is done in every
# cycle of every process.
_STANCE, _PROBING, _COLLAPSING = (
    int(status) for status in (LegStatus.STANCE, LegStatus.PROBING, LegStatus.COLLAPSING)
)


def is_trusted(status: np.ndarray) -> np.ndarray:
    """On ground that has borne its load."""
    return status == _STANCE


def is_probing(status: np.ndarray) -> np.ndarray:
    """On ground that is being tested."""
    return status == _PROBING


def is_sinking(status: np.ndarray) -> np.ndarray:
    """On ground that gives way."""
    return status == _COLLAPSING


def is_firm(status: np.ndarray) -> np.ndarray:
    """On ground that is not known to give way."""
    return is_trusted(status) | is_probing(status)


def is_grounded(status: np.ndarray) -> np.ndarray:
    """On any ground."""
    return is_firm(status) | is_sinking(status)
