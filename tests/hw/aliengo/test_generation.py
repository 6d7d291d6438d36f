"""Every field lies where the vendor's library puts it."""

import pytest

from surefoot.hw.aliengo.generation import BY_LENGTH, G0, G1, MOTORS

OFFSETS = [
    (G1.command, "level_flag 0, version 1, robot_id 3, serial 5, bandwidth 9, motor 10, led 550, remote 562", 610),
    (G1.command, "reserve 602, crc 606", 610),
    (G1.state, "level_flag 0, bandwidth 9, quat 10, gyro 26, acc 38, rpy 50, imu_temperature 62, motor 63", 771),
    (G1.state, "foot_force 703, foot_force_estimate 711, tick 719, remote 723, reserve 763, crc 767", 771),
    (G0.command, "level_flag 0, motor 4, led 484, remote 496, crc 536", 540),
    (G0.state, "level_flag 0, quat 4, gyro 20, acc 32, rpy 44, imu_temperature 56, motor 60", 684),
    (G0.state, "foot_force 620, tick 636, remote 640, crc 680", 684),
]
MOTOR_OFFSETS = [
    (G1.command, "mode 0, q 1, dq 5, tau 9, kp 11, kd 13, reserve 15", 27),
    (
        G1.state,
        "mode 0, q 1, dq 5, ddq 9, tau 11, q_raw 13, dq_raw 17, ddq_raw 21, temperature 23, reserve 24",
        32,
    ),
    (G0.command, "mode 0, q 4, dq 8, kp 12, kd 16, tau 20", 24),
    (G0.state, "mode 0, q 4, dq 8, tau 12, temperature 16", 28),
]


def found(dtype, said):
    names = [part.split()[0] for part in said.split(", ")]
    return ", ".join(f"{name} {dtype.fields[name][1]}" for name in names)


@pytest.mark.parametrize(("layout", "said", "length"), OFFSETS)
def test_fields_of_a_packet(layout, said, length):
    assert found(layout.dtype, said) == said and layout.length == length
    assert layout.dtype.names[-1] == "crc" and layout.dtype.fields["crc"][1] == length - 4


@pytest.mark.parametrize(("layout", "said", "length"), MOTOR_OFFSETS)
def test_fields_of_a_motor(layout, said, length):
    motors = layout.dtype["motor"]
    assert motors.shape == (MOTORS,) and motors.base.itemsize == length
    assert found(motors.base, said) == said


def test_a_packets_length_tells_its_generation_and_direction():
    assert {length: (generation.name, layout.what) for length, (generation, layout) in BY_LENGTH.items()} == {
        610: ("G1", "G1 command"),
        771: ("G1", "G1 state"),
        540: ("G0", "G0 command"),
        684: ("G0", "G0 state"),
    }
