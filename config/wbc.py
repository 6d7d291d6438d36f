"""Settings of the whole-body controller."""

from __future__ import annotations

from dataclasses import dataclass


@dataclass(frozen=True)
class Wbc:
    """Gains, weights and time-outs of the whole-body controller."""
