"""A terminal of which every key is read as it is pressed, and which is left as it was found."""

from __future__ import annotations

import atexit
import os
import re
import select
import signal
import termios
import tty
from types import FrameType

_ARROWS = {b"A": "up", b"B": "down", b"C": "right", b"D": "left"}
_ENDS = (signal.SIGTERM, signal.SIGHUP)
_ESCAPE = b"\x1b"
_KEY = re.compile(rb"\x1b(?:\[[0-?]*[ -/]*[@-~]|O.|.)?|.", re.DOTALL)
_REST_S = 0.05  # of an arrow's three bytes, over a slow link


class RawTerminal:
    """Keys without Enter and without echo; Ctrl-C is still an interrupt, Ctrl-Z does nothing.

    The terminal's settings come back when the block is left, by an error or a signal too, and at the latest when
    the process ends. Only a kill that no process can catch leaves them: `stty sane` mends that.
    """

    def __init__(self, descriptor: int):
        """`descriptor`: such as that of standard input."""
        self._descriptor = descriptor
        self._found: list | None = None
        self._handlers: dict[signal.Signals, object] = {}
        self.closed = False

    def __enter__(self) -> RawTerminal:
        self._found = termios.tcgetattr(self._descriptor)
        atexit.register(self.restore)
        for number in _ENDS:
            self._handlers[number] = signal.signal(number, _leave)
        tty.setcbreak(self._descriptor)
        settings = termios.tcgetattr(self._descriptor)
        settings[6][termios.VSUSP] = b"\0"  # a robot whose driver sleeps hears no stop
        termios.tcsetattr(self._descriptor, termios.TCSADRAIN, settings)
        return self

    def __exit__(self, *_: object) -> None:
        self.restore()
        for number, handler in self._handlers.items():
            signal.signal(number, handler)  # type: ignore[arg-type]

    def restore(self) -> None:
        """The settings that were found; once."""
        found, self._found = self._found, None
        if found is not None:
            atexit.unregister(self.restore)
            try:
                termios.tcsetattr(self._descriptor, termios.TCSADRAIN, found)
            except termios.error:
                return  # the terminal itself is gone

    def keys(self, wait_s: float) -> list[str]:
        """What is pressed, after `wait_s` [s] at the most: characters, or up, down, left, right."""
        data = self._read(wait_s)
        while data.endswith((_ESCAPE, _ESCAPE + b"[", _ESCAPE + b"O")) and (more := self._read(_REST_S)):
            data += more
        return _decoded(data)

    def _read(self, wait_s: float) -> bytes:
        if self.closed or not select.select([self._descriptor], [], [], wait_s)[0]:
            return b""
        try:
            data = os.read(self._descriptor, 64)
        except OSError:  # the terminal is gone
            data = b""
        self.closed = not data
        return data


def _leave(number: int, frame: FrameType | None) -> None:
    raise SystemExit(128 + number)


def _decoded(data: bytes) -> list[str]:
    """The keys in what was read; of those that send a sequence, such as F4, only the arrows count."""
    found = []
    for match in _KEY.finditer(data):
        key = match.group()
        if not key.startswith(_ESCAPE):
            found.append(key.decode(errors="replace"))
        elif key[:-1] in (b"\x1b[", b"\x1bO") and key[-1:] in _ARROWS:
            found.append(_ARROWS[key[-1:]])
    return found
