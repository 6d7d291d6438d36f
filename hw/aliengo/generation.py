"""The two generations of packets: where every field lies. All numbers are little-endian."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np

MOTORS = 20
"""Motors a packet has room for; the first twelve are the robot's."""

LOW_LEVEL = 0xFF
"""Level flag of packets that command or tell of single motors."""


@dataclass(frozen=True)
class Layout:
    """One kind of packet.

    Attributes:
        what: its name in messages.
        dtype: its fields; the checksum is the last.
        covered: how many leading bytes are under the checksum, whole words. What lies between them and the
            checksum (two or three bytes of `reserve` in generation G1) may be damaged unseen; nothing reads it.
    """

    what: str
    dtype: np.dtype
    covered: int

    @property
    def length(self) -> int:
        """Of the packet, in bytes."""
        return self.dtype.itemsize


@dataclass(frozen=True)
class Generation:
    """What one generation of Aliengos speaks.

    Attributes:
        name: G0 or G1.
        command: from PC to robot.
        state: from robot to PC.
        scale: how many units of a field make one of ours, by the field's name; 1 where it is not named.
    """

    name: str
    command: Layout
    state: Layout
    scale: Mapping[str, float]


_G1_HEAD = [("level_flag", "u1"), ("version", "<u2"), ("robot_id", "<u2"), ("serial", "<u4"), ("bandwidth", "u1")]
_IMU = [("quat", "<f4", (4,)), ("gyro", "<f4", (3,)), ("acc", "<f4", (3,)), ("rpy", "<f4", (3,))]

_G1_MOTOR_COMMAND = np.dtype(
    [
        ("mode", "u1"),
        ("q", "<f4"),
        ("dq", "<f4"),
        ("tau", "<i2"),
        ("kp", "<i2"),
        ("kd", "<i2"),
        ("reserve", "<u4", (3,)),
    ]
)
_G1_COMMAND = np.dtype(
    [
        *_G1_HEAD,
        ("motor", _G1_MOTOR_COMMAND, (MOTORS,)),
        ("led", "u1", (4, 3)),
        ("remote", "u1", (40,)),
        ("reserve", "<u4"),
        ("crc", "<u4"),
    ]
)
_G1_MOTOR_STATE = np.dtype(
    [
        ("mode", "u1"),
        ("q", "<f4"),
        ("dq", "<f4"),
        ("ddq", "<i2"),
        ("tau", "<i2"),
        ("q_raw", "<f4"),
        ("dq_raw", "<f4"),
        ("ddq_raw", "<i2"),
        ("temperature", "i1"),
        ("reserve", "<u4", (2,)),
    ]
)
_G1_STATE = np.dtype(
    [
        *_G1_HEAD,
        *_IMU,
        ("imu_temperature", "i1"),
        ("motor", _G1_MOTOR_STATE, (MOTORS,)),
        ("foot_force", "<i2", (4,)),
        ("foot_force_estimate", "<i2", (4,)),  # no SDK of the vendor reads it
        ("tick", "<u4"),
        ("remote", "u1", (40,)),
        ("reserve", "<u4"),
        ("crc", "<u4"),
    ]
)

# The oldest robots send plain C structures with their natural alignment; padding is zero and under the checksum.
_G0_MOTOR_COMMAND = np.dtype(
    [("mode", "u1"), ("q", "<f4"), ("dq", "<f4"), ("kp", "<f4"), ("kd", "<f4"), ("tau", "<f4")], align=True
)
_G0_COMMAND = np.dtype(
    [
        ("level_flag", "u1"),
        ("motor", _G0_MOTOR_COMMAND, (MOTORS,)),
        ("led", "u1", (4, 3)),
        ("remote", "u1", (40,)),
        ("crc", "<u4"),
    ],
    align=True,
)
_G0_MOTOR_STATE = np.dtype(
    [
        ("mode", "u1"),
        ("q", "<f4"),
        ("dq", "<f4"),
        ("tau", "<f4"),
        ("temperature", "<f4"),
        ("reserve", "V8"),
    ],
    align=True,
)
_G0_STATE = np.dtype(
    [
        ("level_flag", "u1"),
        *_IMU,
        ("imu_temperature", "<f4"),
        ("motor", _G0_MOTOR_STATE, (MOTORS,)),
        ("foot_force", "<f4", (4,)),
        ("tick", "<u4"),
        ("remote", "u1", (40,)),
        ("crc", "<u4"),
    ],
    align=True,
)

G0 = Generation("G0", Layout("G0 command", _G0_COMMAND, 536), Layout("G0 state", _G0_STATE, 680), {})
"""aliengo_sdk 1.x."""

G1 = Generation(
    "G1",
    Layout("G1 command", _G1_COMMAND, 604),
    Layout("G1 state", _G1_STATE, 764),
    {"tau": 256.0, "kp": 32.0, "kd": 16.0},
)
"""unitree_legged_sdk 3.2 to 3.3.1, 3.8.2, 3.8.4 and its branch Aliengo: the same bytes in all of them."""

GENERATIONS = {generation.name: generation for generation in (G0, G1)}

BY_LENGTH = {
    layout.length: (generation, layout)
    for generation in GENERATIONS.values()
    for layout in (generation.command, generation.state)
}
"""Generation and layout of a packet from its length; no two kinds are equally long."""
