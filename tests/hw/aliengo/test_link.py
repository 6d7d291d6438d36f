"""The socket hears the robot alone, and says what is wrong with the way there."""

import socket

import pytest

from surefoot.config.aliengo import Aliengo
from surefoot.hw.aliengo.link import Link
from surefoot.hw.aliengo.link_statistics import LinkRecorder
from surefoot.hw.errors import HardwareFault


@pytest.fixture
def robot():
    with socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as end:
        end.bind(("127.0.0.1", 0))
        end.settimeout(60.0)
        yield end


@pytest.fixture
def recorder():
    return LinkRecorder()


@pytest.fixture
def link(robot, recorder):
    opened = Link(Aliengo(address="127.0.0.1", port=robot.getsockname()[1], local_port=0), recorder)
    yield opened
    opened.close()


def test_it_takes_all_that_came_in_order_and_hears_nobody_else(robot, link):
    link.send(b"command")
    command, here = robot.recvfrom(100)
    assert command == b"command"
    with socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as stranger:
        stranger.bind(("127.0.0.1", 0))
        stranger.sendto(b"stranger", here)
    for answer in (b"1", b"2", b"3"):
        robot.sendto(answer, here)
    assert link.wait(60.0)
    assert link.drain() == [b"1", b"2", b"3"] and link.drain() == [] and not link.wait(0.0)


def test_a_flood_is_taken_in_portions(robot, link):
    link.send(b"command")
    here = robot.recvfrom(100)[1]
    for number in range(40):
        robot.sendto(bytes([number]), here)
    portions = [link.drain(), link.drain()]
    assert [len(portion) for portion in portions] == [32, 8]
    assert b"".join(portions[0] + portions[1]) == bytes(range(40))


def test_a_port_where_nobody_listens_is_said(robot, link, recorder):
    robot.close()
    link.send(b"command")
    link.wait(60.0)
    assert link.drain() == []
    found = recorder.statistics()
    assert found.socket_errors == 1 and "refused" in found.trouble


def test_a_port_that_another_program_has_is_named(robot):
    taken = robot.getsockname()[1]
    with pytest.raises(HardwareFault, match=rf"UDP port {taken} of this machine: .*hw\.aliengo\.local_port"):
        Link(Aliengo(address="127.0.0.1", local_port=taken), LinkRecorder())


def test_an_address_that_is_none_is_named():
    with pytest.raises(HardwareFault, match=r"no way to not an address:8007: .*check hw\.aliengo\.address"):
        Link(Aliengo(address="not an address", local_port=0), LinkRecorder())
