"""A link loses, delays, doubles, reorders and damages as often as it is told, and one seed repeats itself."""

import numpy as np
import pytest

from surefoot.config.emulator import Wire
from surefoot.hw.emulator.link_faults import LinkFaults, Packet

PEER = ("127.0.0.1", 8082)
STILL = {"latency_s": 0.0, "jitter_s": 0.0}
PACKETS = [Packet(n.to_bytes(2, "little") * 50, PEER) for n in range(2000)]


def sent(wire, packets=PACKETS, seed=3):
    """(arrivals, the link) of one packet each 2 ms; an arrival is (time of the look, packet)."""
    link = LinkFaults(wire, np.random.default_rng(seed))
    arrivals = []
    for n, packet in enumerate(packets):
        link.send(packet, 0.002 * n)
        arrivals += [(n, arrived) for arrived in link.due(0.002 * n)]
    return arrivals, link


def test_a_sound_link_passes_everything_at_once_and_in_order():
    arrivals, link = sent(Wire(**STILL))
    assert arrivals == list(enumerate(PACKETS)) and link.next_t == np.inf


def test_latency_holds_a_packet_until_its_time():
    link = LinkFaults(Wire(latency_s=0.010, jitter_s=0.0), np.random.default_rng(0))
    link.send(PACKETS[7], 1.0)
    assert link.next_t == 1.01 and link.due(1.0099) == []
    assert link.due(1.01) == [PACKETS[7]] and link.due(2.0) == []


def test_jitter_lies_between_nothing_and_its_setting_and_lets_packets_overtake():
    link = LinkFaults(Wire(latency_s=0.0, jitter_s=0.010), np.random.default_rng(0))
    times = []
    for packet in PACKETS:
        link.send(packet, 1.0)
        times.append(link.next_t)
        link.due(2.0)
    assert min(times) >= 1.0 and max(times) <= 1.010 and np.std(times) > 0.002
    for packet in PACKETS:
        link.send(packet, 3.0)
    assert (came := link.due(4.0)) != PACKETS and sorted(came) == sorted(PACKETS)


@pytest.mark.parametrize("share", [0.0, 0.1, 0.5, 1.0])
def test_loss_has_its_share(share):
    arrivals, _ = sent(Wire(**STILL, loss=share))
    assert abs(1.0 - len(arrivals) / len(PACKETS) - share) < 0.03


def test_a_duplicate_is_the_same_packet_again():
    arrivals, _ = sent(Wire(**STILL, duplicate=0.25))
    again = [packet for (_, packet), (_, before) in zip(arrivals[1:], arrivals, strict=False) if packet == before]
    assert len(arrivals) == len(PACKETS) + len(again) and abs(len(again) / len(PACKETS) - 0.25) < 0.03


def test_what_is_reordered_comes_later_by_its_setting_and_nothing_is_lost():
    arrivals, link = sent(Wire(**STILL, reorder=0.1, reorder_s=0.005))
    numbers = [int.from_bytes(packet.data[:2], "little") for _, packet in arrivals]
    late = [look - number for (look, _), number in zip(arrivals, numbers, strict=True)]
    assert set(late) == {0, 3} and abs(late.count(3) / len(PACKETS) - 0.1) < 0.03
    rest = [int.from_bytes(packet.data[:2], "little") for packet in link.due(1e9)]
    assert sorted(numbers + rest) == list(range(len(PACKETS)))


@pytest.mark.parametrize("bits", [1, 5])
def test_damage_turns_as_many_bits_as_it_is_told_to(bits):
    arrivals, _ = sent(Wire(**STILL, corrupt=0.3, corrupt_bits=bits))
    flipped = [
        (int.from_bytes(came.data, "little") ^ int.from_bytes(packet.data, "little")).bit_count()
        for (_, came), packet in zip(arrivals, PACKETS, strict=True)
    ]
    assert set(flipped) == {0, bits} and abs(flipped.count(bits) / len(PACKETS) - 0.3) < 0.04


def test_a_burst_has_its_begin_and_its_end():
    arrivals, _ = sent(Wire(**STILL, loss=1.0, bad_from_s=1.0, bad_until_s=1.5))
    assert {look for look, _ in arrivals} == {*range(500), *range(750, 2000)}


def test_one_seed_repeats_and_one_setting_does_not_shift_what_another_draws():
    lossy = Wire(**STILL, loss=0.2)
    both = Wire(**STILL, loss=0.2, corrupt=0.5, duplicate=0.5)
    assert sent(lossy)[0] == sent(lossy)[0]
    assert sent(lossy)[0] != sent(lossy, seed=4)[0]
    assert {look for look, _ in sent(lossy)[0]} == {look for look, _ in sent(both)[0]}
