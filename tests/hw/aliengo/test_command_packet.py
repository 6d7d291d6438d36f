"""Motor laws reach the motors as they were meant, or limited with a word, or not at all."""

from dataclasses import replace

import numpy as np
import pytest
from packet_samples import ANY_ANGLE, GOOD_LAW, PLAUSIBILITY, drawn_law, pattern_p

from surefoot.config.robot import JOINT_NAMES
from surefoot.hw.aliengo.command_packet import decode_command, encode_brake, encode_command
from surefoot.hw.aliengo.generation import G0, G1
from surefoot.hw.aliengo.seal import seal
from surefoot.hw.errors import Flaw, PacketError
from surefoot.hw.robot_interface import MotorLaw, damping_law

LIMP = damping_law(0.0)


def crc(packet):
    return int.from_bytes(packet[-4:], "little")


def motors(packet, generation):
    return np.frombuffer(packet, generation.command.dtype)[0]["motor"]


def test_a_law_without_gains_is_the_vendors_first_packet():
    packet, limited = encode_command(LIMP, G1, PLAUSIBILITY)
    assert crc(packet) == 0x1359692F and limited == ()
    assert packet[:37].hex() == "ff000000000000000000" + "0ab9d2ff4e00007a46" + 18 * "00"
    assert crc(encode_command(LIMP, G0, PLAUSIBILITY)[0]) == 0x93D74FA4


def test_the_level_flag_changes_the_checksum_as_the_vendors_does():
    packet = bytearray(encode_command(LIMP, G1, PLAUSIBILITY)[0])
    packet[0] = 0
    assert crc(seal(packet, G1.command)) == 0x77DB73E3


def test_the_vendors_standing_law():
    packet, _ = encode_command(GOOD_LAW, G1, PLAUSIBILITY)
    assert crc(packet) == 0x0388CCB4
    assert (motors(packet, G1)["kp"][:12] == 640).all() and (motors(packet, G1)["kd"][:12] == 32).all()


def test_the_vendors_pattern_with_a_figure_in_every_field():
    packet = pattern_p()
    assert crc(packet) == 0x6108F99E
    stored = motors(packet, G1)[["tau", "kp", "kd"]]
    assert [stored[n].item() for n in (0, 11, 19)] == [(-2560, 640, 32), (1945, 992, 49), (5222, 1248, 62)]
    law = decode_command(packet, G1, ANY_ANGLE).law
    front_right, rear_left = JOINT_NAMES.index("FR_hip"), JOINT_NAMES.index("RL_calf")
    assert law.tau[front_right] == -10.0 and law.tau[rear_left] == 1945 / 256


@pytest.mark.parametrize("generation", [G0, G1], ids=lambda generation: generation.name)
def test_a_law_comes_back_as_exactly_as_the_packet_can_hold_it(generation):
    rng = np.random.default_rng(3)
    for _ in range(200):
        law = drawn_law(rng)
        packet, limited = encode_command(law, generation, PLAUSIBILITY)
        command = decode_command(packet, generation, PLAUSIBILITY)
        assert limited == () and not command.braked.any()
        for name in ("q", "dq", "kp", "kd", "tau"):
            meant, got = getattr(law, name), getattr(command.law, name)
            step = 1.0 / generation.scale[name] if name in generation.scale else 2e-7 * np.abs(meant)
            assert (np.abs(got - meant) <= step).all() and (np.abs(got) <= np.abs(meant) * (1 + 1e-7)).all()
        assert encode_command(command.law, generation, PLAUSIBILITY)[0] == packet


def test_each_joint_is_sent_to_its_own_motor():
    for index, motor in enumerate([3, 4, 5, 0, 1, 2, 9, 10, 11, 6, 7, 8]):
        tau = np.zeros(12)
        tau[index] = 1.0
        packet, _ = encode_command(replace(LIMP, tau=tau), G1, PLAUSIBILITY)
        assert np.flatnonzero(motors(packet, G1)["tau"]).tolist() == [motor]


@pytest.mark.parametrize(
    ("field", "value", "sent", "unit_of_the_packet"),
    [
        ("tau", 200.0, 32767 / 256, 32767),
        ("tau", -200.0, -128.0, -32768),
        ("tau", 128.0, 32767 / 256, 32767),
        ("kp", 2000.0, 32767 / 32, 32767),
        ("kd", 3000.0, 32767 / 16, 32767),
    ],
)
def test_what_does_not_fit_ends_at_the_limit_and_is_said(field, value, sent, unit_of_the_packet):
    values = getattr(GOOD_LAW, field).copy()
    values[4] = value
    packet, limited = encode_command(replace(GOOD_LAW, **{field: values}), G1, PLAUSIBILITY)
    assert motors(packet, G1)[field][1] == unit_of_the_packet
    assert getattr(decode_command(packet, G1, PLAUSIBILITY).law, field)[4] == sent
    assert limited == (f"law.{field} of FR_thigh = {value:g} does not fit the packet: {sent:.6g} is sent",)
    packet, limited = encode_command(replace(GOOD_LAW, **{field: values}), G0, PLAUSIBILITY)
    assert getattr(decode_command(packet, G0, PLAUSIBILITY).law, field)[4] == value and limited == ()


def test_the_largest_figures_that_fit_pass_without_a_word():
    law = replace(GOOD_LAW, tau=np.full(12, 127.998), kp=np.full(12, 1023.98), kd=np.full(12, 2047.95))
    packet, limited = encode_command(law, G1, PLAUSIBILITY)
    assert limited == () and motors(packet, G1)[0][["tau", "kp", "kd"]].item() == (32767, 32767, 32767)


@pytest.mark.parametrize("generation", [G0, G1], ids=lambda generation: generation.name)
def test_a_joint_without_a_gain_has_no_loop_whatever_its_reference(generation):
    law = replace(damping_law(3.0), q=np.full(12, 7.7))
    stored = motors(encode_command(law, generation, PLAUSIBILITY)[0], generation)[:12]
    assert (stored["q"] == np.float32(2.146e9)).all() and not stored["kp"].any() and not stored["dq"].any()
    law = replace(GOOD_LAW, kd=np.zeros(12), dq=np.full(12, 99.0))
    stored = motors(encode_command(law, generation, PLAUSIBILITY)[0], generation)[:12]
    assert (stored["dq"] == 16000.0).all() and not stored["kd"].any()


def test_a_gain_beside_a_switched_off_loop_does_not_act():
    packet = bytearray(encode_command(LIMP, G1, PLAUSIBILITY)[0])
    np.frombuffer(packet, G1.command.dtype)["motor"]["kp"] = 640
    law = decode_command(seal(packet, G1.command), G1, PLAUSIBILITY).law
    assert not law.kp.any() and not law.q.any()


@pytest.mark.parametrize("generation", [G0, G1], ids=lambda generation: generation.name)
def test_brake_mode_asks_for_nothing_else(generation):
    command = decode_command(encode_brake(generation), generation, PLAUSIBILITY)
    assert command.braked.all()
    for name in ("q", "dq", "kp", "kd", "tau"):
        assert not getattr(command.law, name).any()


@pytest.mark.parametrize("generation", [G0, G1], ids=lambda generation: generation.name)
@pytest.mark.parametrize(
    ("field", "value", "flaw", "said"),
    [
        ("q", np.nan, Flaw.NOT_FINITE, r"law\.q of RL_calf = nan rad, allowed -3\.775 to 0\.354"),
        ("dq", np.inf, Flaw.NOT_FINITE, r"law\.dq of RL_calf = inf rad/s"),
        ("tau", np.nan, Flaw.NOT_FINITE, r"law\.tau of RL_calf = nan N m"),
        ("kp", -np.inf, Flaw.NOT_FINITE, r"law\.kp of RL_calf = -inf"),
        ("kd", np.nan, Flaw.NOT_FINITE, r"law\.kd of RL_calf = nan"),
        ("q", 1e9, Flaw.IMPLAUSIBLE, r"law\.q of RL_calf = 1e\+09 rad, .* hw\.aliengo\.plausible\.angle_margin"),
        ("dq", -80.0, Flaw.IMPLAUSIBLE, r"law\.dq of RL_calf = -80 rad/s, allowed -60 to 60: .*joint_speed"),
        ("kp", -1.0, Flaw.IMPLAUSIBLE, r"law\.kp of RL_calf = -1 N m/rad, allowed 0"),
    ],
)
def test_no_robot_is_asked_what_none_can_do(generation, field, value, flaw, said):
    values = getattr(GOOD_LAW, field).copy()
    values[8] = value
    law: MotorLaw = replace(GOOD_LAW, **{field: values})
    with pytest.raises(PacketError, match=said) as caught:
        encode_command(law, generation, PLAUSIBILITY)
    assert caught.value.flaw == flaw


@pytest.mark.parametrize("generation", [G0, G1], ids=lambda generation: generation.name)
@pytest.mark.parametrize(
    ("field", "value", "said"),
    [
        ("q", np.nan, r"law\.q of FL_hip = nan"),
        ("kp", -640, r"law\.kp of FL_hip = -[26]"),
        ("kd", -1, r"law\.kd of FL_hip"),
        ("mode", 0x08, r"mode of FL_hip = 08, known are 0A \(servo\) and 00 \(brake\)"),
    ],
)
def test_a_robot_refuses_it_too(generation, field, value, said):
    packet = bytearray(encode_command(GOOD_LAW, generation, PLAUSIBILITY)[0])
    np.frombuffer(packet, generation.command.dtype)["motor"][field][0, 3] = value
    with pytest.raises(PacketError, match=said):
        decode_command(seal(packet, generation.command), generation, PLAUSIBILITY)


def test_an_angle_that_is_not_a_number_counts_without_a_gain_too():
    """Zero times it is not zero in a motor's firmware."""
    packet = bytearray(encode_command(LIMP, G1, PLAUSIBILITY)[0])
    np.frombuffer(packet, G1.command.dtype)["motor"]["q"][0, 0] = np.nan
    with pytest.raises(PacketError, match=r"law\.q of FR_hip = nan"):
        decode_command(seal(packet, G1.command), G1, PLAUSIBILITY)
