"""One deployment: everything a run needs to know, from one TOML file."""

from __future__ import annotations

import re
from collections.abc import Sequence
from dataclasses import dataclass, field
from pathlib import Path
from typing import Annotated, Literal

from surefoot.config.estimator import Estimator
from surefoot.config.fsm import Fsm
from surefoot.config.hw import Hw
from surefoot.config.mpc import Mpc
from surefoot.config.ocp import Ocp
from surefoot.config.robot import Robot, load_robot
from surefoot.config.terrain import Terrain
from surefoot.config.trajopt import Trajopt
from surefoot.config.typed_toml import ConfigError, Within, build, read_toml, with_override
from surefoot.config.wbc import Wbc


@dataclass(frozen=True)
class Run:
    """How the processes run together."""

    clock: Literal["simulated", "monotonic"] = "simulated"
    command: str = "forward"  # given by the operator's side once the robot stands; "" waits for one
    namespace: str = "surefoot"  # prefix of every key on the wire
    epoch_s: Annotated[float, Within(0.0, 1e10)] = 0.0  # monotonic clock at t = 0, set by the supervisor for all
    log_dir: str = "log"  # where process logs go, relative to the working directory
    solve_share_max: Annotated[float, Within(0.05, 1.0)] = 0.6  # of 10 ms; slower machines run mpc.profile light
    cores_min: Annotated[int, Within(1, 256)] = 4  # likewise with fewer cores: seven processes share them

    def __post_init__(self) -> None:
        if not re.fullmatch(r"[A-Za-z0-9_-]+", self.namespace):
            raise ConfigError(f"namespace = {self.namespace!r}: letters, digits, - and _ only")


@dataclass(frozen=True)
class Deployment:
    """A whole deployment; each section's type holds its defaults."""

    robot: str = "aliengo"
    run: Run = field(default_factory=Run)
    hw: Hw = field(default_factory=Hw)
    terrain: Terrain = field(default_factory=Terrain)
    estimator: Estimator = field(default_factory=Estimator)
    ocp: Ocp = field(default_factory=Ocp)
    mpc: Mpc = field(default_factory=Mpc)
    trajopt: Trajopt = field(default_factory=Trajopt)
    wbc: Wbc = field(default_factory=Wbc)
    fsm: Fsm = field(default_factory=Fsm)

    def load_robot(self) -> Robot:
        """The figures of this deployment's robot."""
        return load_robot(self.robot)


def load_deployment(path: Path | str, overrides: Sequence[str] = ()) -> Deployment:
    """Read a deployment.

    Args:
        path: a TOML file.
        overrides: assignments `section.key=value`, applied in order.

    Raises:
        ConfigError: the file is missing or malformed, a key is unknown or a value has the wrong type.
    """
    table = read_toml(Path(path))
    for assignment in overrides:
        table = with_override(table, assignment)
    try:
        return build(Deployment, table)
    except ConfigError as error:
        raise ConfigError(f"{path}: {error}") from None
