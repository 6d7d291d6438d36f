"""One deployment: everything a run needs to know, from one TOML file."""

from __future__ import annotations

import re
from collections.abc import Sequence
from dataclasses import dataclass, field
from math import sqrt
from pathlib import Path
from typing import Annotated, Literal

from surefoot.config.calibration import Calibration
from surefoot.config.doctor import Doctor
from surefoot.config.elevation_map import ElevationMap
from surefoot.config.emulator import Emulator
from surefoot.config.estimator import Estimator
from surefoot.config.fsm import Fsm
from surefoot.config.hw import Hw
from surefoot.config.mpc import Mpc
from surefoot.config.network import Network
from surefoot.config.ocp import Ocp
from surefoot.config.operator import Operator
from surefoot.config.robot import GRAVITY, Robot, load_robot
from surefoot.config.terrain import Terrain
from surefoot.config.trajopt import Trajopt
from surefoot.config.typed_toml import ConfigError, Within, build, ordered, read_toml, with_override
from surefoot.config.unit import Unit, load_unit
from surefoot.config.wbc import Wbc


@dataclass(frozen=True)
class Run:
    """How the processes run together."""

    clock: Literal["simulated", "monotonic"] = "simulated"  # it waits for every process, or for none
    speed: Annotated[float, Within(0.02, 1.0)] = 1.0  # of a simulated robot on the monotonic clock, against it
    command: str = "forward"  # given by the operator's side once the robot stands; "" waits for one
    vision: bool = False  # a depth camera, a map from it and footholds adapted to it; false: blind
    namespace: str = "surefoot"  # prefix of every key on the wire
    epoch_s: Annotated[float, Within(0.0, 1e10)] = 0.0  # monotonic clock at t = 0, set by the supervisor for all
    log_dir: str = "log"  # where process logs go, relative to the working directory
    solve_share_max: Annotated[float, Within(0.05, 1.0)] = 0.6  # of 10 ms; slower machines run mpc.profile light
    cores_min: Annotated[int, Within(1, 256)] = 4  # likewise with fewer cores: seven processes share them
    realtime_priority: Annotated[int, Within(0, 90)] = 40  # monotonic clock: of the control chain; 0: none asked

    def __post_init__(self) -> None:
        if not re.fullmatch(r"[A-Za-z0-9_-]+", self.namespace):
            raise ConfigError(f"namespace = {self.namespace!r}: letters, digits, - and _ only")


@dataclass(frozen=True)
class Deployment:
    """A whole deployment; each section's type holds its defaults, and what one asks of another is checked here."""

    robot: str = "aliengo"  # its kind, a file in config/robots/
    run: Run = field(default_factory=Run)
    network: Network = field(default_factory=Network)
    operator: Operator = field(default_factory=Operator)
    hw: Hw = field(default_factory=Hw)
    terrain: Terrain = field(default_factory=Terrain)
    estimator: Estimator = field(default_factory=Estimator)
    ocp: Ocp = field(default_factory=Ocp)
    mpc: Mpc = field(default_factory=Mpc)
    trajopt: Trajopt = field(default_factory=Trajopt)
    wbc: Wbc = field(default_factory=Wbc)
    fsm: Fsm = field(default_factory=Fsm)
    elevation_map: ElevationMap = field(default_factory=ElevationMap)
    emulator: Emulator = field(default_factory=Emulator)
    doctor: Doctor = field(default_factory=Doctor)
    calibration: Calibration = field(default_factory=Calibration)

    def __post_init__(self) -> None:
        robot = self.load_robot()
        self._check_backend()
        self._check_gains()
        self._check_plans(robot)
        self._check_forces(robot)
        self._check_reach(robot)

    def load_robot(self) -> Robot:
        """The figures of this deployment's robot."""
        return load_robot(self.robot)

    def load_unit(self) -> Unit | None:
        """What was measured of the robot itself; None without `hw.unit`.

        Raises:
            ConfigError: its file is missing or cannot be used.
        """
        return load_unit(self.hw.unit, self.robot) if self.hw.unit else None

    def _check_backend(self) -> None:
        """A real robot does not wait, nor does it go slower, and has no camera on its link."""
        if self.run.speed != 1.0 and (self.run.clock == "simulated" or self.hw.backend == "aliengo"):
            raise ConfigError(
                f"run.speed = {self.run.speed:g} with run.clock = {self.run.clock!r} and hw.backend = "
                f"{self.hw.backend!r}: only MuJoCo's robot on the monotonic clock can go slower than time does; "
                "set run.speed = 1"
            )
        if self.hw.backend != "aliengo":
            return
        fitting = {"timer": "monotonic", "cycle": "simulated"}
        clock, exchange = self.run.clock, self.hw.aliengo.exchange
        if clock != fitting[exchange]:
            raise ConfigError(
                f"run.clock = {clock!r} with hw.aliengo.exchange = {exchange!r}: a robot does not wait, set "
                "'monotonic' and 'timer'; with an emulator paced by packets 'simulated' and 'cycle'"
            )
        if self.run.vision:
            raise ConfigError(
                "run.vision = true with hw.backend = 'aliengo': there is no camera on the robot's link; set "
                "run.vision = false"
            )

    def _check_gains(self) -> None:
        """The gate damps in every cycle in which a gain is above its limit."""
        for name in ("joint_kp", "posture_kp"):
            ordered(self, f"wbc.{name}", "hw.kp_max", "every command would be refused")
        for name in ("wbc.joint_kd", "wbc.posture_kd", "hw.damping_kd"):
            ordered(self, name, "hw.kd_max", "every command would be refused")

    def _check_plans(self, robot: Robot) -> None:
        """Plans are in explicit Euler steps, and motors have to follow them."""
        ocp = self.ocp
        for name, section in (("mpc", self.mpc), ("trajopt", self.trajopt)):
            if ocp.swing_height_gain * section.interval_s > 2.0:
                raise ConfigError(
                    f"ocp.swing_height_gain = {ocp.swing_height_gain} with {name}.interval_s = "
                    f"{section.interval_s}: a swing foot's height error would grow from node to node; "
                    f"at most {2.0 / section.interval_s:g}, two over the interval"
                )
        slowest = min(robot.per_joint("velocity_limit"))
        if ocp.joint_velocity_limit > slowest:
            raise ConfigError(
                f"ocp.joint_velocity_limit = {ocp.joint_velocity_limit}: at most the {slowest} rad/s that every "
                f"joint of {robot.name} can make"
            )

    def _check_forces(self, robot: Robot) -> None:
        """Four feet at their least and three at their most, or the robot cannot stand."""
        quarter, third = robot.mass * GRAVITY / 4.0, robot.mass * GRAVITY / 3.0
        for name, section in (("ocp", self.ocp), ("wbc", self.wbc)):
            if section.force_min_n >= quarter:
                raise ConfigError(
                    f"{name}.force_min_n = {section.force_min_n}: must be below {quarter:.0f} N, "
                    f"a quarter of {robot.name}'s weight"
                )
            if section.force_max_n <= third:
                raise ConfigError(
                    f"{name}.force_max_n = {section.force_max_n}: must be above {third:.0f} N, "
                    f"a third of {robot.name}'s weight"
                )
        for name, planner in (("ocp", self.ocp), ("trajopt", self.trajopt)):
            asked = sqrt(planner.cone_regularisation_n2) / self.ocp.friction
            if asked >= quarter:
                raise ConfigError(
                    f"{name}.cone_regularisation_n2 = {planner.cone_regularisation_n2} with ocp.friction = "
                    f"{self.ocp.friction} asks {asked:.0f} N of every foot: must be below {quarter:.0f} N, "
                    f"a quarter of {robot.name}'s weight"
                )
        ordered(self, "fsm.fixed_force_n", "ocp.force_max_n", "no foot is ever asked to press that hard")

    def _check_reach(self, robot: Robot) -> None:
        """What the robot is sent to must be within its legs' length, and its start on the ground."""
        height, approach = robot.nominal.leg_height, self.terrain.approach
        for name, most, what in (
            ("leg_length_max_m", robot.reach, "legs reach"),
            ("base_height_min_m", height, "hips stand at"),
            ("leg_up_below_hip_m", height, "hips stand at"),
        ):
            value = getattr(self.fsm, name)
            if value > most:
                raise ConfigError(f"fsm.{name} = {value}: {robot.name}'s {what} {most:.3f} m; lower it")
        stance = robot.legs["FL"].hip_p_B[0] - robot.legs["RL"].hip_p_B[0] + 2.0 * robot.foot.radius
        if approach is not None and approach.run_up_m < stance + approach.start_offset_m:
            raise ConfigError(
                f"terrain.{self.terrain.kind}.run_up_m = {approach.run_up_m}: {robot.name} starts on it and needs "
                f"{stance + approach.start_offset_m:.2f} m, start_offset_m included"
            )


def load_deployment(path: Path | str, overrides: Sequence[str] = ()) -> Deployment:
    """Read a deployment.

    Args:
        path: a TOML file.
        overrides: assignments `section.key=value`, applied in order.

    Raises:
        ConfigError: the file is missing or malformed, a key is unknown, or a value has the wrong type, is out of
            its limits or does not go with another.
    """
    table = read_toml(Path(path))
    for assignment in overrides:
        table = with_override(table, assignment)
    try:
        return build(Deployment, table)
    except ConfigError as error:
        raise ConfigError(f"{path}: {error}") from None
