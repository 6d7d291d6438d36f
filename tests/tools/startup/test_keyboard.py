"""Lines are read as they come, and nobody waits for them."""

import os

import pytest

from surefoot.tools.startup.keyboard import Keyboard


@pytest.fixture
def pipe():
    """Its two ends, and what reads from it."""
    read, write = os.pipe()
    yield Keyboard(read), write
    os.close(read)


def test_only_whole_lines_count_and_of_several_the_newest(pipe):
    keyboard, write = pipe
    assert keyboard.line() is None
    os.write(write, b"y")
    assert keyboard.line() is None
    os.write(write, b"\nn\nh\n")
    assert keyboard.line() == "h" and keyboard.line() is None
    os.write(write, b"\n")
    assert keyboard.line() == ""
    os.close(write)


def test_one_that_is_closed_says_no(pipe):
    keyboard, write = pipe
    os.write(write, b"y\n")
    os.close(write)
    assert keyboard.line() == keyboard.line() == "n"
