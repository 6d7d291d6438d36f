"""What a driver and an emulator whose time waits hand each other in one cycle.

No robot knows of it. The packets in it are a robot's, as a link delivers them: none, one or several in a cycle,
whole or damaged. The turn around them says which cycle it is and when there is no more to come, so that a cycle in
which everything is lost ends too, and a turn that is sent twice is taken once.
"""

from __future__ import annotations

import struct
from dataclasses import dataclass

_HEAD = struct.Struct("<4sQ")
_MARK = b"turn"  # no packet of a robot begins like that
_LENGTH = struct.Struct("<H")


@dataclass(frozen=True)
class Turn:
    """One way of an exchange.

    Attributes:
        number: of the cycle, counted up by the driver; the answer has the same.
        packets: in order of arrival.
    """

    number: int
    packets: tuple[bytes, ...]


def encode_turn(turn: Turn) -> bytes:
    """As one datagram."""
    framed = (_LENGTH.pack(len(packet)) + packet for packet in turn.packets)
    return _HEAD.pack(_MARK, turn.number) + b"".join(framed)


def decode_turn(datagram: bytes) -> Turn | None:
    """The turn of a datagram; None if it is none, or not whole."""
    if len(datagram) < _HEAD.size:
        return None
    mark, number = _HEAD.unpack_from(datagram)
    if mark != _MARK:
        return None
    packets, at = [], _HEAD.size
    while at < len(datagram):
        begin = at + _LENGTH.size
        if begin > len(datagram):
            return None
        at = begin + _LENGTH.unpack_from(datagram, begin - _LENGTH.size)[0]
        packets.append(datagram[begin:at])
    return Turn(number, tuple(packets)) if at == len(datagram) else None
