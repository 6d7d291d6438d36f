"""Settings of `surefoot doctor` and the guided start-up: which figures are said, and with which nothing moves."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Annotated

from surefoot.config.quantities import Share
from surefoot.config.typed_toml import Within, ordered

Milliseconds = Annotated[float, Within(0.01, 1000.0)]
Celsius = Annotated[float, Within(0.0, 125.0)]


@dataclass(frozen=True)
class Doctor:
    """Of two limits the first is a warning, the second a failure."""

    watch_s: Annotated[float, Within(0.2, 60.0)] = 1.2  # how long the link, and this machine's timer, are watched

    # The link.
    loss_warn: Share = 0.01  # commands without a new state, and damaged packets
    loss_fail: Share = 0.10
    latency_warn_ms: Milliseconds = 1.5  # from command to state, median
    latency_fail_ms: Milliseconds = 10.0  # half of what a motor law lives

    # The robot at rest.
    tilt_max: Annotated[float, Within(0.05, 1.5)] = 0.35  # of the trunk, before it is moved [rad]
    gravity_error: Annotated[float, Within(0.1, 9.0)] = 1.0  # of the mean specific force's length [m/s^2]
    still_rad_s: Annotated[float, Within(0.01, 5.0)] = 0.15  # mean angular velocity of a trunk that rests
    lie_error: Annotated[float, Within(0.05, 3.0)] = 0.6  # of each joint, from the folded posture [rad]
    motor_warm: Celsius = 55.0  # [deg C]
    motor_hot: Celsius = 75.0

    # This machine.
    jitter_warn_ms: Milliseconds = 0.5  # a timer of 500 Hz is late by, 99th percentile
    jitter_fail_ms: Milliseconds = 4.0  # two cycles
    load_warn: Annotated[float, Within(0.05, 10.0)] = 0.7  # of other programs, for each core
    free_warn_gb: Annotated[float, Within(0.001, 10000.0)] = 5.0  # where logs go; a recording takes 4 MB a second
    free_fail_gb: Annotated[float, Within(0.0, 10000.0)] = 0.2

    def __post_init__(self) -> None:
        for warn, fail in (
            ("loss_warn", "loss_fail"),
            ("latency_warn_ms", "latency_fail_ms"),
            ("motor_warm", "motor_hot"),
            ("jitter_warn_ms", "jitter_fail_ms"),
            ("free_fail_gb", "free_warn_gb"),
        ):
            ordered(self, warn, fail, "it would fail before it is warned of")
