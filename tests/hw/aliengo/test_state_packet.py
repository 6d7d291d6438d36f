"""What the robot measured arrives in our units and orders, and garbage is refused by name."""

from dataclasses import fields, replace

import numpy as np
import pytest
from packet_samples import ANY_ANGLE, PLAUSIBILITY, READING, drawn_state, pattern_s

from surefoot.config.aliengo import Plausible, Reading
from surefoot.config.robot import JOINT_NAMES
from surefoot.hw.aliengo.generation import G0, G1
from surefoot.hw.aliengo.remote import Remote
from surefoot.hw.aliengo.state_packet import decode_state, encode_state
from surefoot.hw.errors import Flaw, PacketError

GENERATIONS = pytest.mark.parametrize("generation", [G0, G1], ids=lambda generation: generation.name)


def test_the_vendors_pattern_with_a_figure_in_every_field():
    packet = pattern_s()
    assert int.from_bytes(packet[-4:], "little") == 0x80629C8F
    state = decode_state(packet, G1, READING, ANY_ANGLE)
    motor = np.array([3, 4, 5, 0, 1, 2, 9, 10, 11, 6, 7, 8])  # of FL, FR, RL, RR
    np.testing.assert_allclose(state.quat_WB, [0.9, 0.1, 0.2, 0.3], atol=1e-7)
    np.testing.assert_allclose(state.omega_WB_B, [1.1, 1.2, 1.3], atol=1e-6)
    np.testing.assert_allclose(state.acc_B, [4.1, 4.2, 9.8], atol=1e-6)
    np.testing.assert_allclose(state.rpy, [0.01, 0.02, 0.03], atol=1e-8)
    np.testing.assert_array_equal(state.q, 0.5 + motor)
    np.testing.assert_array_equal(state.dq, -1.5 - motor)
    np.testing.assert_array_equal(state.ddq, 100.0 + motor)
    np.testing.assert_array_equal(state.tau, (1280 + motor) / 256)
    np.testing.assert_array_equal(state.foot_force, [2.0, 1.0, 4.0, 3.0])
    assert (state.mode == 0x0A).all() and (state.temperature == 45.0).all()
    assert state.imu_temperature == -41.0 and state.tick == 123456


def same(one, other, tolerance):
    for field in fields(one):
        mine, others = getattr(one, field.name), getattr(other, field.name)
        if isinstance(mine, Remote) or mine is None:
            assert mine == others
        else:
            np.testing.assert_allclose(
                mine, others, rtol=1e-7, atol=tolerance.get(field.name, 0.0), err_msg=field.name
            )


@GENERATIONS
def test_a_state_comes_back_as_exactly_as_the_packet_can_hold_it(generation):
    rng = np.random.default_rng(4)
    for tick in rng.integers(0, 2**32, 200).tolist():
        state = drawn_state(rng, tick)
        if generation is G0:
            state = replace(state, ddq=None)
        packet, limited = encode_state(state, generation, READING)
        decoded = decode_state(packet, generation, READING, PLAUSIBILITY)
        assert limited == ()
        same(state, decoded, {"tau": 1 / 256} if generation is G1 else {})
        assert encode_state(decoded, generation, READING)[0] == packet


@GENERATIONS
def test_each_motor_is_read_as_its_own_joint(generation):
    state = replace(drawn_state(np.random.default_rng(5)), dq=np.arange(12.0))
    record = np.frombuffer(encode_state(state, generation, READING)[0], generation.state.dtype)[0]
    names = [JOINT_NAMES[int(dq)] for dq in record["motor"]["dq"][:12]]
    assert names == [f"{leg}_{joint}" for leg in ("FR", "FL", "RR", "RL") for joint in ("hip", "thigh", "calf")]


def test_what_the_vendor_leaves_open_is_a_setting():
    state = drawn_state(np.random.default_rng(6))
    asked = Reading(g0_quaternion="xyzw", accelerometer="down")
    packet, _ = encode_state(state, G0, asked)
    record = np.frombuffer(packet, G0.state.dtype)[0]
    np.testing.assert_allclose(record["quat"], np.roll(state.quat_WB, -1), atol=1e-7)
    np.testing.assert_allclose(record["acc"], -state.acc_B, atol=1e-5)
    np.testing.assert_allclose(decode_state(packet, G0, asked, PLAUSIBILITY).quat_WB, state.quat_WB, atol=1e-7)
    np.testing.assert_allclose(decode_state(packet, G0, asked, PLAUSIBILITY).acc_B, state.acc_B, atol=1e-5)
    record = np.frombuffer(encode_state(state, G1, asked)[0], G1.state.dtype)[0]
    np.testing.assert_allclose(record["quat"], state.quat_WB, atol=1e-7)


@pytest.mark.parametrize(
    ("field", "value", "sent"),
    [("tau", -500.0, "-128"), ("ddq", 1e5, "32767"), ("temperature", 200.0, "127"), ("foot_force", 4e4, "32767")],
)
def test_what_does_not_fit_ends_at_the_limit_and_is_said(field, value, sent):
    state = drawn_state(np.random.default_rng(7))
    values = getattr(state, field).copy()
    values[1] = value
    _, limited = encode_state(replace(state, **{field: values}), G1, READING)
    name = "FR" if field == "foot_force" else "FL_thigh"
    assert limited == (f"state.{field} of {name} = {value:.6g} does not fit the packet: {sent} is sent",)


@pytest.mark.parametrize(
    ("field", "value", "flaw", "said"),
    [
        ("q", np.nan, Flaw.NOT_FINITE, r"state\.q of FR_hip = nan rad, allowed -2\.047 to 1\.873"),
        ("q", 7.0, Flaw.IMPLAUSIBLE, r"state\.q of FR_hip = 7 rad, .*plausible\.angle_margin"),
        ("dq", -61.0, Flaw.IMPLAUSIBLE, r"state\.dq of FR_hip = -61 rad/s, allowed -60 to 60: .*joint_speed"),
        ("dq", np.inf, Flaw.NOT_FINITE, r"state\.dq of FR_hip = inf"),
        ("tau", 127.0, Flaw.IMPLAUSIBLE, r"state\.tau of FR_hip = 127 N m, allowed -120 to 120"),
        ("temperature", 126.0, Flaw.IMPLAUSIBLE, r"state\.temperature of FR_hip = 126 deg C, allowed -50 to 125"),
        ("omega_WB_B", 41.0, Flaw.IMPLAUSIBLE, r"state\.omega_WB_B of z = 41 rad/s, allowed -40 to 40"),
        ("acc_B", -301.0, Flaw.IMPLAUSIBLE, r"state\.acc_B of z = -301 m/s\^2"),
        ("rpy", np.nan, Flaw.NOT_FINITE, r"state\.rpy of yaw = nan rad"),
        ("quat_WB", np.nan, Flaw.NOT_FINITE, r"state\.quat_WB of z = nan"),
        ("quat_WB", 1.5, Flaw.IMPLAUSIBLE, r"norm of state\.quat_WB = .*allowed 1 \+- 0\.05"),
    ],
)
@GENERATIONS
def test_what_no_robot_measures_is_refused(generation, field, value, flaw, said):
    state = drawn_state(np.random.default_rng(8))
    values = getattr(state, field).copy()
    values[3 if len(values) in (4, 12) else 2] = value
    packet, _ = encode_state(replace(state, **{field: values}), generation, READING)
    with pytest.raises(PacketError, match=said) as caught:
        decode_state(packet, generation, READING, PLAUSIBILITY)
    assert caught.value.flaw == flaw


def test_an_imu_that_does_not_run_yet_is_no_measurement():
    state = replace(drawn_state(np.random.default_rng(9)), quat_WB=np.zeros(4))
    with pytest.raises(PacketError, match=r"norm of state\.quat_WB = 0, .*the IMU does not run yet"):
        decode_state(encode_state(state, G1, READING)[0], G1, READING, PLAUSIBILITY)


def test_a_foot_sensor_that_is_not_a_number_is_refused():
    state = replace(drawn_state(np.random.default_rng(10)), foot_force=np.array([0.0, 0.0, np.nan, 0.0]))
    with pytest.raises(PacketError, match=r"state\.foot_force of RL = nan"):
        decode_state(encode_state(state, G0, READING)[0], G0, READING, PLAUSIBILITY)


def test_the_limits_are_settings():
    assert Plausible().angle_margin < Plausible(angle_margin=20.0).angle_margin
    state = decode_state(pattern_s(), G1, READING, ANY_ANGLE)
    with pytest.raises(PacketError, match=r"state\.q of FL_hip = 3\.5 rad"):
        decode_state(encode_state(state, G1, READING)[0], G1, READING, PLAUSIBILITY)
