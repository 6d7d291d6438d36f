"""One robot, as `surefoot calibrate` has measured it: what its sensors read when there is nothing to read."""

from __future__ import annotations

from dataclasses import dataclass, fields
from pathlib import Path
from typing import Annotated, Literal

from surefoot.config.quantities import Share
from surefoot.config.typed_toml import ConfigError, Within, build, read_toml

Rate = Annotated[float, Within(-1.0, 1.0)]
Specific = Annotated[float, Within(-5.0, 5.0)]
Moment = Annotated[float, Within(-20.0, 20.0)]
Loss = Annotated[float, Within(0.0, 20.0)]
Raw = Annotated[float, Within(-32768.0, 32767.0)]  # what the packet's integer holds
Scale = Annotated[float, Within(1e-4, 1e3)]
Celsius = Annotated[float, Within(-50.0, 125.0)]

Joints = tuple[Moment, Moment, Moment, Moment, Moment, Moment, Moment, Moment, Moment, Moment, Moment, Moment]
Losses = tuple[Loss, Loss, Loss, Loss, Loss, Loss, Loss, Loss, Loss, Loss, Loss, Loss]


@dataclass(frozen=True)
class Measured:
    """How a figure was come by."""

    date: str  # UTC
    pose: Literal["standing", "hung"]
    seconds: Annotated[float, Within(0.0, 1e5)]  # of the robot's time that were averaged
    temperature: Celsius | None = None  # of the motors, mean [deg C]; left out where the robot did not tell


@dataclass(frozen=True)
class Gyroscope:
    """What it reads at rest."""

    measured: Measured
    bias: tuple[Rate, Rate, Rate]  # in the trunk frame [rad/s]


@dataclass(frozen=True)
class Accelerometer:
    """What it reads beyond gravity, as far as the attitudes in which it was measured tell."""

    measured: Measured
    bias: tuple[Specific, Specific, Specific]  # in the trunk frame [m/s^2]
    basis: Literal["along gravity", "level floor", "attitudes"]  # known across gravity too but for the first


@dataclass(frozen=True)
class Torque:
    """What the torque estimates read of motors that do nothing; joints FL, FR, RL, RR: hip, thigh, calf."""

    measured: Measured
    offset: Joints  # [N m]
    noise: Losses  # standard deviation of one sample [N m]


@dataclass(frozen=True)
class Friction:
    """What the joints lose; the torque estimates do not know of it. Nothing is corrected by it."""

    measured: Measured
    coulomb: Losses  # [N m]
    viscous: Losses  # [N m s/rad]
    coulomb_std: Losses  # of the fit [N m]
    viscous_std: Losses  # [N m s/rad]


@dataclass(frozen=True)
class FootZero:
    """What the foot sensors read in the air; feet FL, FR, RL, RR."""

    measured: Measured
    raw: tuple[Raw, Raw, Raw, Raw]


@dataclass(frozen=True)
class FootScale:
    """What one more of a foot sensor's raw figure is worth."""

    measured: Measured
    force: tuple[Scale, Scale, Scale, Scale]  # [N]
    weight_share: Share  # what was missing or too much in the torques' sum, of the weight


@dataclass(frozen=True)
class Unit:
    """What has been measured of one robot; what has not is None, and stays as the sensors give it."""

    robot: str  # its kind, as in config/robots
    gyroscope: Gyroscope | None = None
    accelerometer: Accelerometer | None = None
    torque: Torque | None = None
    friction: Friction | None = None
    foot_zero: FootZero | None = None
    foot_scale: FootScale | None = None

    def __post_init__(self) -> None:
        if self.foot_scale is not None and self.foot_zero is None:
            raise ConfigError("foot_scale without foot_zero: a scale counts from zero; give both, or neither")

    @property
    def parts(self) -> tuple[str, ...]:
        """Names of what has been measured."""
        return tuple(f.name for f in fields(self) if f.name != "robot" and getattr(self, f.name) is not None)


def load_unit(path: Path | str, robot: str) -> Unit:
    """Read a robot file.

    Args:
        path: of the file, relative to the working directory.
        robot: the kind it must be of.

    Raises:
        ConfigError: it is missing, malformed or out of limits, or it is of another kind of robot.
    """
    try:
        unit = build(Unit, read_toml(Path(path)))
    except ConfigError as error:
        raise ConfigError(f"robot file {path}: {error}") from None
    if unit.robot != robot:
        raise ConfigError(f"robot file {path} is of robot {unit.robot!r}, not {robot!r}: check hw.unit")
    return unit
