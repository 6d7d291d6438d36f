"""The wire to the robot."""

from __future__ import annotations

import select
import socket

from surefoot.config.aliengo import Aliengo
from surefoot.hw.aliengo.link_statistics import LinkRecorder
from surefoot.hw.errors import HardwareFault

_LONGEST = 65535  # more than a datagram has room for: one that is too long shows
_AT_ONCE = 32  # more than can have come since the last look; a flood must not hold up the next command


class Link:
    """A UDP socket that knows the robot alone: what comes from elsewhere is dropped by the kernel."""

    def __init__(self, settings: Aliengo, recorder: LinkRecorder):
        """Open it; nothing is sent yet.

        Args:
            settings: where the robot is.
            recorder: told of what the socket complains of.

        Raises:
            HardwareFault: the local port is taken, or there is no way to the robot.
        """
        self._where = f"{settings.address}:{settings.port}"
        self._recorder = recorder
        self._socket = socket.socket(socket.AF_INET, socket.SOCK_DGRAM)
        self._socket.setblocking(False)
        try:
            self._socket.bind(("", settings.local_port))
        except OSError as error:
            self._socket.close()
            raise HardwareFault(
                f"UDP port {settings.local_port} of this machine: {error.strerror}; does another program speak to "
                "the robot? end it, or set hw.aliengo.local_port"
            ) from None
        try:
            self._socket.connect((settings.address, settings.port))
        except OSError as error:
            self._socket.close()
            raise HardwareFault(
                f"no way to {self._where}: {error.strerror}; give this machine's wired port an address in the "
                "robot's network, such as 192.168.123.162/24, and check hw.aliengo.address"
            ) from None

    def send(self, packet: bytes) -> None:
        """Send at once; what cannot be sent is dropped and counted."""
        try:
            self._socket.send(packet)
        except OSError as error:
            self._complain(error)

    def wait(self, seconds: float) -> bool:
        """Whether something came, or is to be complained of, before the time was over."""
        return bool(select.select([self._socket], [], [], max(seconds, 0.0))[0])

    def drain(self) -> list[bytes]:
        """What has come, in order."""
        packets: list[bytes] = []
        for _ in range(_AT_ONCE):
            try:
                packets.append(self._socket.recv(_LONGEST))
            except BlockingIOError:
                break
            except OSError as error:
                self._complain(error)
        return packets

    @property
    def is_open(self) -> bool:
        return self._socket.fileno() >= 0

    def close(self) -> None:
        self._socket.close()

    def _complain(self, error: OSError) -> None:
        self._recorder.socket_error(f"{self._where}: {error.strerror}")
