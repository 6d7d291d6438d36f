"""State packets as what the robot measured, and back."""

from __future__ import annotations

import numpy as np

from surefoot.config.aliengo import Reading
from surefoot.hw.aliengo.aliengo_state import AliengoState
from surefoot.hw.aliengo.fixed_point import store
from surefoot.hw.aliengo.generation import LOW_LEVEL, Generation
from surefoot.hw.aliengo.joint_order import VENDOR_JOINTS, VENDOR_LEGS, swap_joints, swap_legs
from surefoot.hw.aliengo.plausibility import Plausibility
from surefoot.hw.aliengo.remote import decode_remote, encode_remote
from surefoot.hw.aliengo.seal import seal, unseal

_W_FIRST, _W_LAST = np.arange(4), np.array([3, 0, 1, 2])

_OF_MOTORS = ("q", "dq", "ddq", "tau", "temperature")


def decode_state(
    packet: bytes, generation: Generation, reading: Reading, plausibility: Plausibility
) -> AliengoState:
    """What the robot measured.

    Args:
        packet: as it came.
        generation: of the robot.
        reading: what the vendor's files leave open.
        plausibility: the robot's limits.

    Raises:
        PacketError: the packet is not whole, not low-level, or tells what no robot can measure.
    """
    record = unseal(packet, generation.state, any_level=reading.level_flag == "any")
    motor = record["motor"][:12]
    told = {
        name: swap_joints(motor[name].astype(float)) / generation.scale.get(name, 1.0)
        for name in _OF_MOTORS
        if name in motor.dtype.names
    }
    state = AliengoState(
        quat_WB=record["quat"].astype(float)[_places(generation, reading)],
        omega_WB_B=record["gyro"].astype(float),
        acc_B=_upwards(reading) * record["acc"].astype(float),
        rpy=record["rpy"].astype(float),
        imu_temperature=float(record["imu_temperature"]),
        mode=swap_joints(motor["mode"]),
        q=told["q"],
        dq=told["dq"],
        ddq=told.get("ddq"),
        tau=told["tau"],
        temperature=told["temperature"],
        foot_force=swap_legs(record["foot_force"].astype(float)),
        tick=int(record["tick"]),
        remote=decode_remote(record["remote"]),
    )
    plausibility.check_state(state)
    return state


def encode_state(state: AliengoState, generation: Generation, reading: Reading) -> tuple[bytes, tuple[str, ...]]:
    """The packet a robot sends; what nobody reads in it is zero.

    Returns:
        The packet; in words which figures were limited to what an integer holds, and to what.
    """
    packet = bytearray(generation.state.length)
    record = np.frombuffer(packet, generation.state.dtype)
    motor = record["motor"][0, :12]
    record["level_flag"] = LOW_LEVEL
    record["quat"][0, _places(generation, reading)] = state.quat_WB
    record["gyro"] = state.omega_WB_B
    record["acc"] = _upwards(reading) * state.acc_B
    record["rpy"] = state.rpy
    record["tick"] = state.tick
    record["remote"] = encode_remote(state.remote)
    motor["mode"] = swap_joints(state.mode)
    limited: tuple[str, ...] = ()
    for name in _OF_MOTORS:
        figures = getattr(state, name)
        if figures is not None and name in (motor.dtype.names or ()):
            scale = generation.scale.get(name, 1.0)
            limited += store(motor[name], f"state.{name}", VENDOR_JOINTS, swap_joints(figures), scale)
    limited += store(record["foot_force"][0], "state.foot_force", VENDOR_LEGS, swap_legs(state.foot_force))
    temperature = np.array([state.imu_temperature])
    limited += store(record["imu_temperature"], "state.imu_temperature", ("the IMU",), temperature)
    return seal(packet, generation.state), limited


def _places(generation: Generation, reading: Reading) -> np.ndarray:
    """(4,) where w, x, y and z are in a quaternion of the packet."""
    return _W_LAST if generation.name == "G0" and reading.g0_quaternion == "xyzw" else _W_FIRST


def _upwards(reading: Reading) -> float:
    """What makes an acceleration of the packet specific force."""
    return 1.0 if reading.accelerometer == "up" else -1.0
