"""What one run of an experiment is. Imports nothing that draws: the renderer's process reads it first."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path

from surefoot.config.deployment import Deployment, load_deployment
from surefoot.tools.evaluation.arms import arm_overrides

ROOT = Path(__file__).resolve().parents[2]
"""Where the rooms are."""


@dataclass(frozen=True)
class RunSpec:
    """What is run.

    Attributes:
        scenario: a deployment in config/, or a path.
        arm: as `surefoot eval` knows it.
        seed: of the plant and its noise.
        limit_s: simulated time at which the run is cut off [s].
        recorders: names in `recorded_run.RECORDERS`.
        overrides: further settings, as KEY=VALUE.
        label: where one arm runs twice; otherwise the arm's name.
    """

    scenario: str
    arm: str
    seed: int
    limit_s: float
    recorders: tuple[str, ...]
    overrides: tuple[str, ...] = ()
    label: str = ""

    @property
    def name(self) -> str:
        """Of its folder, and in lines of progress."""
        return f"{self.label or self.arm}_seed{self.seed}".replace("=", "_")

    def deployment(self) -> Deployment:
        """The whole deployment.

        Raises:
            ConfigError: there is no such scenario, arm or setting.
        """
        own = ROOT / "config" / f"{self.scenario}.toml"
        changes = [*arm_overrides(self.arm), *self.overrides, f"hw.seed={self.seed}"]
        return load_deployment(own if own.is_file() else Path(self.scenario), changes)
