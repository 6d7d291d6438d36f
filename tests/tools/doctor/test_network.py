"""The way to the robot, in made-up surroundings."""

from dataclasses import replace
from ipaddress import IPv4Address

import pytest

from surefoot.config.aliengo import Aliengo
from surefoot.tools.doctor.check import Level
from surefoot.tools.doctor.network import Surroundings, check_network, look_around, routes, way_to

TABLE = """Iface Destination Gateway Flags RefCnt Use Metric Mask MTU Window IRTT
wlan0 00000000 0101A8C0 0003 0 0 600 00000000 0 0 0
wlan0 0001A8C0 00000000 0001 0 0 600 00FFFFFF 0 0 0
eth0 007BA8C0 00000000 0001 0 0 100 00FFFFFF 0 0 0
eth1 007BA8C0 00000000 0000 0 0 100 FFFFFFFF 0 0 0
"""
ROBOT = IPv4Address("192.168.123.10")
WIRE = Aliengo()
WIRED = Surroundings(ROBOT, way_to(ROBOT, routes(TABLE)), "192.168.123.162", cable=True)


def found(seen, wire=WIRE):
    return {finding.check: finding for finding in check_network(seen, wire)}


def test_the_narrowest_route_that_is_up_is_taken():
    route = way_to(ROBOT, routes(TABLE))
    assert route.interface == "eth0" and str(route.network) == "192.168.123.0/24" and route.gateway is None
    assert str(way_to(IPv4Address("8.8.8.8"), routes(TABLE)).gateway) == "192.168.1.1"
    assert way_to(ROBOT, routes(TABLE.splitlines()[0])) is None


def test_a_wired_interface_in_the_robots_network_is_well():
    assert {finding.level for finding in found(WIRED).values()} == {Level.OK}
    assert found(WIRED)["interface"].found == "eth0 has 192.168.123.162 in 192.168.123.0/24"


def test_an_emulator_is_on_this_machine():
    emulator = Aliengo(address="127.0.0.1", local_port=0)
    assert {finding.level for finding in check_network(look_around(emulator, ""), emulator)} == {Level.OK}


@pytest.mark.parametrize(
    ("change", "check", "level", "words"),
    [
        ({"route": None}, "interface", Level.FAIL, "no route to 192.168.123.10"),
        (
            {"route": way_to(IPv4Address("1.1.1.1"), routes(TABLE))},
            "interface",
            Level.FAIL,
            "by way of 192.168.1.1",
        ),
        ({"address": None}, "interface", Level.FAIL, "no such host"),
        ({"cable": False}, "cable", Level.FAIL, "eth0 has no link"),
        ({"wireless": True}, "cable", Level.WARN, "eth0 is wireless"),
        ({"port_error": "8082: in use"}, "local port", Level.FAIL, "8082: in use"),
        (
            {"port_error": "8082: in use", "owner": "process 7"},
            "local port",
            Level.WARN,
            "a run is up (process 7)",
        ),
    ],
)
def test_what_is_amiss_is_told_with_what_to_do(change, check, level, words):
    finding = found(replace(WIRED, **change))[check]
    assert finding.level is level and words in finding.found and finding.remedy and finding.expected


def test_a_port_that_is_taken_is_seen():
    import socket

    with socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as taken:
        taken.bind(("", 0))
        port = taken.getsockname()[1]
        assert look_around(Aliengo(address="127.0.0.1", local_port=port), "").port_error.startswith(str(port))
