"""Motor laws as command packets, and back."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from surefoot.hw.aliengo.fixed_point import store
from surefoot.hw.aliengo.generation import GENERATIONS, LOW_LEVEL, Generation
from surefoot.hw.aliengo.joint_order import VENDOR_JOINTS, swap_joints
from surefoot.hw.aliengo.plausibility import Plausibility
from surefoot.hw.aliengo.seal import seal, unseal
from surefoot.hw.errors import Flaw, PacketError
from surefoot.hw.robot_interface import MotorLaw

SERVO = 0x0A
"""Mode of a motor that follows the motor law."""

BRAKE = 0x00
"""Mode of a motor that is shorted: it resists motion and follows nothing."""

NO_POSITION = np.float32(2.146e9)
"""Stands for an angle where there is no position loop [rad]; its gain is zero as well."""

NO_VELOCITY = np.float32(16000.0)
"""Stands for a velocity where there is no velocity loop [rad/s]; its gain is zero as well."""


@dataclass(frozen=True, eq=False)
class AliengoCommand:
    """What a command packet asks of the twelve motors."""

    law: MotorLaw  # angles and velocities without a gain are 0
    braked: np.ndarray  # (12,) bool: in brake mode, where the law is not followed


def _idle(generation: Generation, mode: int) -> bytes:
    """A command, not sealed, in which no motor has a loop or a torque; what has no known use is 0."""
    packet = bytearray(generation.command.length)
    record = np.frombuffer(packet, generation.command.dtype)[0:1]
    record["level_flag"] = LOW_LEVEL
    record["motor"]["mode"] = mode
    record["motor"]["q"] = NO_POSITION
    record["motor"]["dq"] = NO_VELOCITY
    return bytes(packet)


_IDLE = {name: _idle(generation, SERVO) for name, generation in GENERATIONS.items()}


def encode_command(
    law: MotorLaw, generation: Generation, plausibility: Plausibility
) -> tuple[bytes, tuple[str, ...]]:
    """The packet that makes the motors follow a law.

    Args:
        law: of the twelve joints. Where a gain is zero, or too small for the packet, its loop is switched off.
        generation: of the robot.
        plausibility: the robot's limits.

    Returns:
        The packet; in words which figures were limited to what an integer holds, and to what.

    Raises:
        PacketError: the law is not finite, or no robot could follow it.
    """
    plausibility.check_law(law)
    packet = bytearray(_IDLE[generation.name])
    motor = np.frombuffer(packet, generation.command.dtype)["motor"][0, :12]
    limited: tuple[str, ...] = ()
    for name in ("tau", "kp", "kd"):
        figures, scale = swap_joints(getattr(law, name)), generation.scale.get(name, 1.0)
        limited += store(motor[name], f"law.{name}", VENDOR_JOINTS, figures, scale)
    motor["q"] = np.where(motor["kp"] != 0, swap_joints(law.q), NO_POSITION)
    motor["dq"] = np.where(motor["kd"] != 0, swap_joints(law.dq), NO_VELOCITY)
    return seal(packet, generation.command), limited


def encode_brake(generation: Generation) -> bytes:
    """The packet that brakes every motor without a law."""
    return seal(bytearray(_idle(generation, BRAKE)), generation.command)


def decode_command(packet: bytes, generation: Generation, plausibility: Plausibility) -> AliengoCommand:
    """What a packet asks of the motors, as the robot understands it.

    Raises:
        PacketError: the packet is not whole, not low-level, or asks what no robot could follow.
    """
    motor = unseal(packet, generation.command)["motor"][:12]
    _check_modes(motor["mode"])
    q, dq, kp, kd, tau = (
        swap_joints(motor[name].astype(float)) / generation.scale.get(name, 1.0)
        for name in ("q", "dq", "kp", "kd", "tau")
    )
    kp, kd = np.where(q == NO_POSITION, 0.0, kp), np.where(dq == NO_VELOCITY, 0.0, kd)
    law = MotorLaw(
        q=np.where(q == NO_POSITION, 0.0, q), dq=np.where(dq == NO_VELOCITY, 0.0, dq), kp=kp, kd=kd, tau=tau
    )
    plausibility.check_law(law)
    return AliengoCommand(law, swap_joints(motor["mode"]) == BRAKE)


def _check_modes(modes: np.ndarray) -> None:
    strange = (modes != SERVO) & (modes != BRAKE)
    if strange.any():
        motor = int(np.argmax(strange))
        raise PacketError(
            Flaw.IMPLAUSIBLE,
            f"mode of {VENDOR_JOINTS[motor]}",
            f"{int(modes[motor]):02X}",
            f"known are {SERVO:02X} (servo) and {BRAKE:02X} (brake)",
            "the sender is at fault, or speaks to another generation",
        )
