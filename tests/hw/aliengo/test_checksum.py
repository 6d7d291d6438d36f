"""The checksum is the vendor's, and covers what the vendor's covers."""

import numpy as np
import pytest

from surefoot.hw.aliengo.checksum import checksum
from surefoot.hw.aliengo.generation import G0, G1


@pytest.mark.parametrize(
    ("word", "crc"), [(0x00000000, 0xC704DD7B), (0x00000001, 0xC3C5C0CC), (0x12345678, 0xDF8A8A2B)]
)
def test_one_word(word, crc):
    assert checksum(word.to_bytes(4, "little")) == crc


@pytest.mark.parametrize(
    ("layout", "crc"),
    [
        (G1.command, 0xC0038EC9),
        (G1.state, 0xC54DCDDD),
        (G0.command, 0x6ABC5877),
        (G0.state, 0x951CB701),
    ],
    ids=lambda value: getattr(value, "what", ""),
)
def test_a_packet_of_zeros(layout, crc):
    assert checksum(bytes(layout.covered)) == crc


def test_zeros_but_for_the_level_flag():
    assert checksum(b"\xff" + bytes(G1.command.covered - 1)) == 0xA4819405


def divide(crc, value, bits):
    """Go on with a CRC by the bits of a value, the most significant first: CRC-32/MPEG-2 as it is published."""
    for bit in range(bits - 1, -1, -1):
        carry = (crc >> 31) ^ (value >> bit & 1)
        crc = (crc << 1 & 0xFFFFFFFF) ^ (0x04C11DB7 * carry)
    return crc


def test_it_equals_the_division_bit_by_bit():
    rng = np.random.default_rng(1)
    for words in range(1, 40):
        data = rng.bytes(4 * words)
        crc = 0xFFFFFFFF
        for word in np.frombuffer(data, "<u4").tolist():
            crc = divide(crc, word, 32)
        assert checksum(data) == crc


def test_it_is_crc_32_mpeg_2_of_the_words_in_network_order():
    assert divide(checksum(b"4321" + b"8765"), ord("9"), 8) == 0x0376E6E7  # published of "123456789"
