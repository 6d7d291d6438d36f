"""Keys as a terminal sends them."""

import os
import pty
import termios

import pytest

from surefoot.tools.teleop.raw_terminal import RawTerminal


@pytest.fixture
def pair():
    ends = pty.openpty()
    yield ends
    for each in ends:
        os.close(each)


@pytest.mark.parametrize(
    ("sent", "keys"),
    [
        (b"wX ", ["w", "X", " "]),
        (b"\x1b[A\x1b[B\x1bOC\x1b[D", ["up", "down", "right", "left"]),
        (b"\x1bOSq", ["q"]),  # F4 is no stop
        (b"\x1b[3~\x1b[1;5Ck", ["k"]),  # delete, control and an arrow
        (b"\x1bX", []),  # Alt and X is no cut
    ],
)
def test_of_what_a_terminal_sends_only_characters_and_arrows_count(pair, sent, keys):
    master, slave = pair
    with RawTerminal(slave) as terminal:
        os.write(master, sent)
        assert terminal.keys(1.0) == keys


def test_an_arrow_that_comes_in_pieces_is_one(pair):
    master, slave = pair
    with RawTerminal(slave) as terminal:
        os.write(master, 63 * b"w" + b"\x1b[A")  # what one look takes ends in it
        assert terminal.keys(1.0) == [*63 * "w", "up"]


def test_an_error_leaves_the_terminal_as_it_was_found(pair):
    _, slave = pair
    before = termios.tcgetattr(slave)
    with pytest.raises(KeyError), RawTerminal(slave):
        assert not termios.tcgetattr(slave)[3] & (termios.ECHO | termios.ICANON)
        raise KeyError
    assert termios.tcgetattr(slave) == before
