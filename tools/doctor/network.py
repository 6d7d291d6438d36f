"""Checks of the way to the robot: an address in its network, the cable, the local port."""

from __future__ import annotations

import socket
from dataclasses import dataclass
from ipaddress import IPv4Address, IPv4Network
from pathlib import Path

from surefoot.config.aliengo import LOOPBACK, Aliengo
from surefoot.tools.doctor.check import Finding, Level, well

_ROUTES = Path("/proc/net/route")
_INTERFACES = Path("/sys/class/net")
_UP, _REJECT = 0x1, 0x200  # flags of a route


@dataclass(frozen=True)
class Route:
    """One way out of this machine."""

    interface: str
    network: IPv4Network
    gateway: IPv4Address | None


@dataclass(frozen=True)
class Surroundings:
    """What this machine has of the way to the robot.

    Attributes:
        address: the robot's as an IP address, or None where its name is not known.
        route: that packets to it take; None: none.
        own: this machine's address on it; empty: none.
        cable: whether the interface has a link; None where nobody tells.
        wireless: the interface is a radio.
        port_error: why the local port cannot be had; empty when it can.
        owner: in words the run that is up; empty: none is.
    """

    address: IPv4Address | None
    route: Route | None = None
    own: str = ""
    cable: bool | None = None
    wireless: bool = False
    port_error: str = ""
    owner: str = ""


def check_network(seen: Surroundings, wire: Aliengo) -> list[Finding]:
    """All findings of this group."""
    findings = [check_way(seen, wire)]
    if seen.route is not None:
        findings.append(check_cable(seen))
    return [*findings, check_port(seen, wire)]


def check_way(seen: Surroundings, wire: Aliengo) -> Finding:
    """Whether an interface has an address in the robot's network."""
    check, expected = "interface", f"an address in the network of {wire.address}"
    remedy = "give the wired port a fixed one, such as 192.168.123.162/24 for the robot's 192.168.123.10"
    if wire.address in LOOPBACK:
        return well(check, f"{wire.address} is this machine: an emulator", expected)
    if seen.address is None:
        remedy = "set hw.aliengo.address to the IP address of the control board"
        return Finding(check, Level.FAIL, f"no such host: {wire.address}", expected, remedy)
    if seen.route is None:
        return Finding(check, Level.FAIL, f"no route to {wire.address}", expected, remedy)
    if seen.route.gateway is not None:
        found = f"{seen.route.interface} leads there only by way of {seen.route.gateway}"
        return Finding(check, Level.FAIL, found, expected, remedy)
    return well(check, f"{seen.route.interface} has {seen.own} in {seen.route.network}", expected)


def check_cable(seen: Surroundings) -> Finding:
    """Whether the interface is wired, and its cable in."""
    check, expected = "cable", "a wired interface with a link"
    name = seen.route.interface if seen.route is not None else ""
    if seen.cable is False:
        return Finding(
            check, Level.FAIL, f"{name} has no link", expected, "plug the cable in, switch the robot on"
        )
    if seen.wireless:
        remedy = "use the cable: radio loses and delays packets"
        return Finding(check, Level.WARN, f"{name} is wireless", expected, remedy)
    return well(check, f"{name} {'has a link' if seen.cable else 'does not tell'}", expected)


def check_port(seen: Surroundings, wire: Aliengo) -> Finding:
    """Whether nobody else speaks to the robot from here."""
    check, expected = "local port", f"UDP port {wire.local_port or 'of any number'} is free"
    if seen.owner:
        remedy = "`surefoot status` shows how it is; end it to have the robot examined"
        return Finding(check, Level.WARN, f"a run is up ({seen.owner})", expected, remedy)
    if seen.port_error:
        remedy = f"end the program that has it (`ss -ulpn 'sport = {wire.local_port}'`)"
        remedy += ", or set hw.aliengo.local_port"
        return Finding(check, Level.FAIL, seen.port_error, expected, remedy)
    return well(check, "free", expected)


def look_around(wire: Aliengo, owner: str) -> Surroundings:
    """Of this machine as it is now; `owner`: in words the run that is up, or empty."""
    error = _port_error(wire.local_port)
    try:
        address = IPv4Address(socket.gethostbyname(wire.address))
    except (OSError, ValueError):
        return Surroundings(None, port_error=error, owner=owner)
    route = way_to(address, routes(_ROUTES.read_text())) if _ROUTES.exists() and not address.is_loopback else None
    if route is None:
        return Surroundings(address, port_error=error, owner=owner)
    interface = _INTERFACES / route.interface
    return Surroundings(
        address,
        route,
        _own_address(address, wire.port),
        _carrier(interface / "carrier"),
        (interface / "wireless").exists(),
        error,
        owner,
    )


def routes(table: str) -> list[Route]:
    """The usable routes of the kernel's table; its numbers are hexadecimal, in the order of the wire."""
    found = []
    for line in table.splitlines()[1:]:
        interface, target, gateway, flags, _, _, _, mask, *_ = line.split()
        if int(flags, 16) & _UP and not int(flags, 16) & _REJECT:
            network = IPv4Network((_address(target), str(_address(mask))))
            by_way_of = _address(gateway)
            found.append(Route(interface, network, by_way_of if int(by_way_of) else None))
    return found


def way_to(address: IPv4Address, table: list[Route]) -> Route | None:
    """The narrowest route that has the address in it."""
    fitting = [route for route in table if address in route.network]
    return max(fitting, key=lambda route: route.network.prefixlen, default=None)


def _address(word: str) -> IPv4Address:
    return IPv4Address(bytes.fromhex(word)[::-1])


def _own_address(address: IPv4Address, port: int) -> str:
    with socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as probe:
        try:
            probe.connect((str(address), port))
        except OSError:
            return ""
        return probe.getsockname()[0]


def _carrier(path: Path) -> bool | None:
    try:
        return path.read_text().strip() == "1"
    except OSError:  # an interface that is down does not tell
        return None


def _port_error(port: int) -> str:
    with socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as probe:
        try:
            probe.bind(("", port))
        except OSError as error:
            return f"{port}: {error.strerror}"
    return ""
