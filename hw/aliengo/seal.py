"""What all packets share: a length, a level flag, a checksum."""

from __future__ import annotations

import numpy as np

from surefoot.hw.aliengo.checksum import checksum
from surefoot.hw.aliengo.generation import BY_LENGTH, LOW_LEVEL, Layout
from surefoot.hw.errors import Flaw, PacketError


def seal(packet: bytearray, layout: Layout) -> bytes:
    """The packet with its checksum at the end."""
    packet[-4:] = checksum(memoryview(packet)[: layout.covered]).to_bytes(4, "little")
    return bytes(packet)


def unseal(packet: bytes, layout: Layout, any_level: bool = False) -> np.void:
    """The fields of a packet that is whole.

    Args:
        packet: as it came.
        layout: what it must be.
        any_level: also take a packet that does not call itself low-level.

    Raises:
        PacketError: its length, its checksum or its level flag is wrong.
    """
    if len(packet) != layout.length:
        raise _of_another_length(len(packet), layout)
    record = np.frombuffer(packet, layout.dtype)[0]
    told, found = int(record["crc"]), checksum(memoryview(packet)[: layout.covered])
    if told != found:
        raise PacketError(
            Flaw.CHECKSUM,
            f"checksum of a {layout.what} packet",
            f"{told:08X}",
            f"its bytes give {found:08X}",
            "damaged on the way, or another firmware; check the cable if it goes on",
        )
    level = int(record["level_flag"])
    if level != LOW_LEVEL and not any_level:
        raise PacketError(
            Flaw.LEVEL,
            f"level flag of a {layout.what} packet",
            f"{level:02X}",
            f"low level is {LOW_LEVEL:02X}",
            "bring the robot into its low-level mode; hw.aliengo.reading.level_flag = 'any' takes every state",
        )
    return record


def _of_another_length(length: int, layout: Layout) -> PacketError:
    remedy = "is another program or robot on this port?"
    if length in BY_LENGTH:
        generation, known = BY_LENGTH[length]
        remedy = (
            f"this is a {known.what} packet; if the robot sent it, set hw.aliengo.generation = {generation.name}"
        )
    return PacketError(
        Flaw.LENGTH, f"length of a {layout.what} packet", f"{length} bytes", f"must be {layout.length}", remedy
    )
