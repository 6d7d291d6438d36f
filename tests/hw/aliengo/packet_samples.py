"""Packets with known bytes, and laws and states drawn from a seed."""

import numpy as np

from surefoot.config.aliengo import Plausible, Reading
from surefoot.config.robot import load_robot
from surefoot.hw.aliengo.aliengo_state import AliengoState
from surefoot.hw.aliengo.command_packet import encode_command
from surefoot.hw.aliengo.fixed_point import store
from surefoot.hw.aliengo.generation import G1
from surefoot.hw.aliengo.joint_order import swap_joints
from surefoot.hw.aliengo.plausibility import Plausibility
from surefoot.hw.aliengo.remote import Button, Remote
from surefoot.hw.aliengo.seal import seal
from surefoot.hw.robot_interface import MotorLaw

ROBOT = load_robot("aliengo")
READING = Reading()
PLAUSIBILITY = Plausibility(ROBOT, Plausible())
ANY_ANGLE = Plausibility(ROBOT, Plausible(angle_margin=20.0))
"""For the vendor's patterns, whose angles no leg can take."""

GOOD_LAW = MotorLaw(
    q=np.tile([0.0, 0.9, -1.8], 4),
    dq=np.zeros(12),
    kp=np.full(12, 20.0),
    kd=np.full(12, 2.0),
    tau=np.zeros(12),
)


def drawn_law(rng):
    """A law inside the robot's limits, some joints without loops."""
    low, high = np.array(ROBOT.position_range()).T
    kp = rng.uniform(0.5, 400.0, 12) * (rng.random(12) > 0.3)
    kd = rng.uniform(0.5, 20.0, 12) * (rng.random(12) > 0.3)
    q = rng.uniform(low, high) * (kp > 0.0)
    return MotorLaw(
        q=q, dq=rng.uniform(-15.0, 15.0, 12) * (kd > 0.0), kp=kp, kd=kd, tau=rng.uniform(-44.0, 44.0, 12)
    )


def drawn_state(rng, tick=0):
    """A state inside the robot's limits."""
    low, high = np.array(ROBOT.position_range()).T
    quat = rng.normal(size=4)
    return AliengoState(
        quat_WB=quat / np.linalg.norm(quat),
        omega_WB_B=rng.uniform(-10.0, 10.0, 3),
        acc_B=rng.uniform(-30.0, 30.0, 3),
        rpy=rng.uniform(-3.0, 3.0, 3),
        imu_temperature=float(rng.integers(-20, 90)),
        mode=rng.integers(0, 12, 12).astype(np.uint8),
        q=rng.uniform(low, high),
        dq=rng.uniform(-20.0, 20.0, 12),
        ddq=rng.integers(-3000, 3000, 12).astype(float),
        tau=rng.uniform(-44.0, 44.0, 12),
        temperature=rng.integers(-20, 90, 12).astype(float),
        foot_force=rng.integers(-300, 300, 4).astype(float),
        tick=tick,
        remote=Remote(Button.L2 | Button.A, *rng.integers(-4, 5, 4) / 4.0),
    )


def pattern_p():
    """A G1 command in which every field has a figure of its own; returns the packet."""
    i = np.arange(20, dtype=np.float32)
    q, dq = np.float32(0.1) * i, np.float32(-0.2) * i
    tau, kp, kd = np.float32(1.6) * i - 10, 20 + i, 2 + np.float32(0.1) * i
    law = MotorLaw(*(swap_joints(values[:12].astype(float)) for values in (q, dq, kp, kd, tau)))
    packet = bytearray(encode_command(law, G1, ANY_ANGLE)[0])
    record = np.frombuffer(packet, G1.command.dtype)
    record["version"], record["robot_id"], record["serial"] = 0x1234, 0x5678, 0x9ABCDEF0
    record["bandwidth"], record["reserve"] = 0x42, 0xAABBCCDD
    idle = record["motor"][0, 12:]
    idle["q"], idle["dq"] = q[12:], dq[12:]
    for name, values in (("tau", tau), ("kp", kp), ("kd", kd)):
        store(idle[name], name, [""] * 8, values[12:], G1.scale[name])
    record["motor"]["reserve"] = 0x01010101 * (np.arange(20)[:, None] + np.arange(3))
    record["led"] = np.arange(4)[:, None] + [10, 20, 30]
    record["remote"] = 100 + np.arange(40)
    return seal(packet, G1.command)


def pattern_s():
    """A G1 state in which every field has a figure of its own; returns the packet."""
    packet = bytearray(G1.state.length)
    record = np.frombuffer(packet, G1.state.dtype)
    i = np.arange(20)
    record["level_flag"], record["version"], record["robot_id"] = 0xFF, 0x1111, 0x2222
    record["serial"], record["bandwidth"], record["reserve"] = 0x33333333, 0x44, 0x0BADCAFE
    record["quat"], record["gyro"] = [0.9, 0.1, 0.2, 0.3], [1.1, 1.2, 1.3]
    record["acc"], record["rpy"], record["imu_temperature"] = [4.1, 4.2, 9.8], [0.01, 0.02, 0.03], -41
    motor = record["motor"][0]
    motor["mode"], motor["q"], motor["dq"], motor["ddq"] = 0x0A, 0.5 + i, -1.5 - i, 100 + i
    motor["tau"], motor["q_raw"], motor["dq_raw"], motor["ddq_raw"] = 1280 + i, 0.25 + i, -2.25, -77
    motor["temperature"] = 45
    motor["reserve"] = np.stack([0xDEAD0000 + i, 0xBEEF0000 + i], axis=1)
    record["foot_force"], record["foot_force_estimate"] = [1, 2, 3, 4], [11, 12, 13, 14]
    record["tick"], record["remote"] = 123456, 50 + np.arange(40)
    return seal(packet, G1.state)
