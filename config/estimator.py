"""Settings of the state estimator."""

from __future__ import annotations

from dataclasses import dataclass


@dataclass(frozen=True)
class Estimator:
    """Noise densities and thresholds of the contact-aided filter."""
