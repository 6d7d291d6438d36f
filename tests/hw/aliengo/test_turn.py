"""A turn is what it was, or it is none."""

import pytest

from surefoot.hw.aliengo.turn import Turn, decode_turn, encode_turn

TURN = Turn(2**40, (b"\xff" * 771, b"", b"\x00" * 684))


@pytest.mark.parametrize("turn", [TURN, Turn(0, ())])
def test_it_comes_back_as_it_was(turn):
    assert decode_turn(encode_turn(turn)) == turn


def test_what_is_cut_off_or_has_more_is_none():
    whole = encode_turn(TURN)
    ends = {len(encode_turn(Turn(TURN.number, TURN.packets[:n]))) for n in range(4)}
    assert all((decode_turn(whole[:n]) is None) == (n not in ends) for n in range(len(whole)))
    assert decode_turn(whole + b"\1") is None


def test_no_packet_of_a_robot_is_one():
    assert (
        decode_turn(b"\xff" + bytes(609)) is None and decode_turn(bytes(771)) is None and decode_turn(b"") is None
    )
