"""Lines that a person types, without waiting for them."""

from __future__ import annotations

import os
import select


class Keyboard:
    """Reads a terminal, or whatever a descriptor is of."""

    def __init__(self, descriptor: int):
        """`descriptor`: such as that of standard input."""
        self._descriptor = descriptor
        self._begun = b""
        self._closed = False

    def line(self) -> str | None:
        """The newest line that is complete since the last call; None: there is none. One that is closed says n."""
        lines: list[bytes] = []
        while not self._closed and select.select([self._descriptor], [], [], 0.0)[0]:
            data = self._read()
            self._closed = not data
            *complete, self._begun = (self._begun + data).split(b"\n")
            lines += complete
        if self._closed:
            return "n"
        return lines[-1].decode(errors="replace") if lines else None

    def _read(self) -> bytes:
        try:
            return os.read(self._descriptor, 1024)
        except OSError:  # the terminal is gone
            return b""
