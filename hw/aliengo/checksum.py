"""The checksum at the end of every packet."""

from __future__ import annotations

import zlib

import numpy as np

_MIRRORED = bytes(int(f"{byte:08b}"[::-1], 2) for byte in range(256))
"""Every byte with its bits in reverse."""


def checksum(words: bytes | bytearray | memoryview) -> int:
    """CRC over little-endian 32-bit words, each from its most significant bit on.

    Polynomial 0x04C11DB7, start 0xFFFFFFFF, neither reflected nor inverted at the end: it equals CRC-32/MPEG-2
    of the data with every group of four bytes in reverse. `zlib.crc32` has the same polynomial and start, but goes
    from each byte's least significant bit and inverts at the end; mirrored bits before and after make it this one.

    Args:
        words: a whole number of words.

    Returns:
        32 bits, stored little-endian in a packet.
    """
    mirrored = np.frombuffer(words, "<u4").byteswap().tobytes().translate(_MIRRORED)
    crc = zlib.crc32(mirrored) ^ 0xFFFFFFFF
    return int.from_bytes(crc.to_bytes(4, "big").translate(_MIRRORED), "little")
