"""What lies between a driver and an emulator on one machine, and is not the link that the emulator makes up."""

import socket
from contextlib import contextmanager
from threading import Event, Thread


class LossyRoad:
    """Hands datagrams on, each way in its own manner.

    Attributes:
        port: for the driver.
        handed: how many datagrams it was given in all.
    """

    def __init__(self, port, fate):
        """`fate(n)`: how many copies of the n-th datagram go on; "late" lets the next one overtake it."""
        self._fate, self._ended, self._held, self.handed = fate, Event(), {}, 0
        self._near, self._far = (socket.socket(socket.AF_INET, socket.SOCK_DGRAM) for _ in range(2))
        self._near.bind(("127.0.0.1", 0))
        self._far.connect(("127.0.0.1", port))
        self.port, self._driver = self._near.getsockname()[1], None
        self._threads = [Thread(target=self._carry, args=way, daemon=True) for way in ("up", "down")]

    def _carry(self, *way):
        up = "".join(way) == "up"
        source = self._near if up else self._far
        source.settimeout(0.05)
        while not self._ended.is_set():
            try:
                data, sender = source.recvfrom(65535)
            except TimeoutError:
                continue
            if up:
                self._driver = sender
            self.handed += 1
            copies = self._fate(self.handed)
            if copies == "late":
                self._held[up] = data
                continue
            for each in [data] * copies + ([self._held.pop(up)] if up in self._held else []):
                self._far.send(each) if up else self._near.sendto(each, self._driver)

    def open(self):
        for thread in self._threads:
            thread.start()

    def close(self):
        self._ended.set()
        for thread in self._threads:
            thread.join()
        self._near.close()
        self._far.close()


@contextmanager
def lossy_road(port, fate):
    """A road to a port for the time of a test."""
    road = LossyRoad(port, fate)
    road.open()
    try:
        yield road
    finally:
        road.close()
