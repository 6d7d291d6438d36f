"""What is held on the remote is known by its letters."""

import struct
from typing import get_args

import numpy as np
import pytest

from surefoot.config.aliengo import Button as Name
from surefoot.config.aliengo import Chords
from surefoot.hw.aliengo.remote import Button, Remote, StopChords, buttons_of, decode_remote, encode_remote


def data(buttons=0, lx=0.0, rx=0.0, ry=0.0, ly=0.0):
    packed = struct.pack("<2xHfff4xf16x", buttons, lx, rx, ry, ly)
    return np.frombuffer(packed, np.uint8)


VENDOR_ORDER = (
    *("R1", "L1", "START", "SELECT", "R2", "L2", "F1", "F2"),
    *("A", "B", "X", "Y", "UP", "RIGHT", "DOWN", "LEFT"),
)


@pytest.mark.parametrize(
    ("bit", "name"),
    list(enumerate(VENDOR_ORDER)),
)
def test_each_button_has_its_bit(bit, name):
    assert decode_remote(data(1 << bit)).buttons == Button[name]


def test_buttons_and_sticks_come_back():
    remote = Remote(Button.L1 | Button.L2 | Button.START, lx=-1.0, ly=0.5, rx=0.25, ry=-0.75)
    assert decode_remote(encode_remote(remote)) == remote
    assert encode_remote(remote).tobytes() == data(0x26, -1.0, 0.25, -0.75, 0.5).tobytes()


def test_what_a_remote_that_is_off_leaves_there_holds_nothing():
    assert decode_remote(data()) == Remote()
    assert decode_remote(data(lx=np.nan, ly=np.inf, rx=-1e30, ry=2.0)) == Remote(lx=0.0, ly=1.0, rx=-1.0, ry=1.0)


def test_settings_know_the_buttons_by_the_same_names():
    assert get_args(Name) == VENDOR_ORDER


@pytest.mark.parametrize(
    ("held", "stop"),
    [
        ("", ""),
        ("L2", ""),
        ("B", ""),
        ("L2 A", ""),  # of the vendor's way into low-level control
        ("L1 L2 START", ""),
        ("L2 B", "settle"),
        ("L2 B UP", "settle"),
        ("L1 L2 R1", ""),
        ("L1 L2 R1 R2", "cut"),
        ("L1 L2 R1 R2 B", "cut"),
    ],
)
def test_chords_stop_the_robot_and_other_buttons_do_not(held, stop):
    assert StopChords(Chords()).held(Remote(buttons_of(held.split()))) == stop


def test_bytes_that_no_thumb_can_hold_stop_nothing():
    assert StopChords(Chords()).held(decode_remote(np.full(40, 255, np.uint8))) == ""


def test_chords_are_settings_and_an_empty_one_has_no_meaning():
    chords = StopChords(Chords(settle=("X",), cut=()))
    assert chords.held(Remote(Button.X)) == "settle"
    assert chords.held(Remote(Button.L1 | Button.L2 | Button.R1 | Button.R2)) == ""
