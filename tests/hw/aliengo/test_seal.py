"""No damaged packet is taken for a whole one."""

import numpy as np
import pytest
from packet_samples import GOOD_LAW, PLAUSIBILITY, READING, drawn_state

from surefoot.hw.aliengo.command_packet import decode_command, encode_command
from surefoot.hw.aliengo.generation import G0, G1
from surefoot.hw.aliengo.seal import seal, unseal
from surefoot.hw.aliengo.state_packet import decode_state, encode_state
from surefoot.hw.errors import Flaw, PacketError

KINDS = [G0.command, G0.state, G1.command, G1.state]


def whole(layout):
    generation = G0 if layout in (G0.command, G0.state) else G1
    if layout is generation.command:
        return encode_command(GOOD_LAW, generation, PLAUSIBILITY)[0]
    return encode_state(drawn_state(np.random.default_rng(2)), generation, READING)[0]


def flipped(packet, bit):
    damaged = bytearray(packet)
    damaged[bit // 8] ^= 1 << bit % 8
    return bytes(damaged)


@pytest.mark.parametrize("layout", KINDS, ids=lambda layout: layout.what)
def test_every_single_bit_under_the_checksum_or_in_it_counts(layout):
    packet = whole(layout)
    unseal(packet, layout)
    covered = range(8 * layout.covered)
    for bit in (*covered, *range(8 * (layout.length - 4), 8 * layout.length)):
        with pytest.raises(PacketError) as caught:
            unseal(flipped(packet, bit), layout)
        assert caught.value.flaw == Flaw.CHECKSUM


@pytest.mark.parametrize(
    ("layout", "bytes_"), list(zip(KINDS, ([], [], [604, 605], [764, 765, 766]), strict=True))
)
def test_what_no_checksum_covers_is_in_reserve_and_changes_nothing(layout, bytes_):
    assert list(range(layout.covered, layout.length - 4)) == bytes_
    packet = whole(layout)
    for byte in bytes_:
        read = unseal(flipped(packet, 8 * byte), layout)
        unharmed = unseal(packet, layout)
        assert [name for name in layout.dtype.names if (read[name] != unharmed[name]).any()] == ["reserve"]


@pytest.mark.parametrize("layout", KINDS, ids=lambda layout: layout.what)
@pytest.mark.parametrize("length", [0, 1, 4, 539, 609, 611, 770, 772, 2048])
def test_any_other_length_is_refused(layout, length):
    with pytest.raises(
        PacketError, match=f"= {length} bytes, must be {layout.length}: is another program"
    ) as caught:
        unseal(bytes(length), layout)
    assert caught.value.flaw == Flaw.LENGTH


def test_a_packet_of_the_other_generation_is_named():
    with pytest.raises(PacketError, match=r"G1 state packet = 684 bytes.*G0 state packet; .*generation = G0"):
        unseal(whole(G0.state), G1.state)


def test_only_low_level_packets_are_taken_unless_a_firmware_does_not_say():
    for generation in (G0, G1):
        high = bytearray(whole(generation.state))
        high[0] = 0x00
        packet = seal(high, generation.state)
        with pytest.raises(PacketError, match=r"level flag .* = 00, low level is FF: .*reading\.level_flag"):
            decode_state(packet, generation, READING, PLAUSIBILITY)
        assert int(unseal(packet, generation.state, any_level=True)["level_flag"]) == 0
        command = bytearray(whole(generation.command))
        command[0] = 0x00
        with pytest.raises(PacketError, match="level flag"):
            decode_command(seal(command, generation.command), generation, PLAUSIBILITY)
