"""Settings of the trajectory optimisation of one stride."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Annotated

from surefoot.config.quantities import ConeRounding
from surefoot.config.typed_toml import ConfigError, Tuned, Within, ordered

_ROUNDING_S = 1e-9


@dataclass(frozen=True)
class Trajopt:
    """A stride of 4.0 s (Sec. II-B.3): each leg in turn, on four feet first, then in swing.

    The swings have the height and the speeds of section fsm.
    """

    intervals: Annotated[int, Within(10, 1000)] = 80
    interval_s: Annotated[float, Within(0.005, 0.5)] = 0.05
    shift_s: Annotated[float, Within(0.0, 10.0)] = 0.35  # on four feet before each swing
    swing_s: Annotated[float, Within(0.05, 10.0)] = 0.65
    iterations: Annotated[int, Within(1, 200)] = 5
    tolerance: Annotated[float, Within(0.0, 1.0)] = 1e-3  # largest state change at which the SQP stops
    envelope_trim_s: Annotated[float, Within(0.0, 1.0)] = 0.05  # of the stance phase, left out at both ends
    envelope_scale: Tuned[Annotated[float, Within(0.1, 5.0)]] = 1.0
    cone_regularisation_n2: ConeRounding = 25.0  # rounder than the MPC's: asks at least 10 N of a stance foot

    def __post_init__(self) -> None:
        ordered(self, "interval_s", "swing_s", "a swing could pass between two nodes and the foot never leave")
        turn, whole = self.shift_s + self.swing_s, self.intervals * self.interval_s
        if 4.0 * turn > whole + _ROUNDING_S:
            raise ConfigError(
                f"shift_s + swing_s = {turn:g} for each of four legs is longer than intervals * interval_s = "
                f"{whole:g} s: the last foot would not land; shorten the one or lengthen the other"
            )
        # The foot that moves first lands after one turn and stands to the end; two intervals must be left of that.
        longest = 0.5 * (whole - turn) - self.interval_s
        if self.envelope_trim_s > longest:
            raise ConfigError(
                f"envelope_trim_s = {self.envelope_trim_s} leaves nothing of the {whole - turn:g} s of stance "
                f"that the envelope is taken from: at most {longest:g}"
            )
