"""A process that this one did not start."""

from __future__ import annotations

import os
import select
import signal
import time
from contextlib import suppress

_LOOK_S = 0.05


class OtherProcess:
    """A process by its id. Where the kernel has them a file descriptor holds it: ids are given out again.

    Attributes:
        pid: its id.
    """

    def __init__(self, pid: int):
        """Hold a process.

        Raises:
            ProcessLookupError: there is none with that id.
        """
        self.pid = pid
        self._fd: int | None = None
        if hasattr(os, "pidfd_open"):
            self._fd = os.pidfd_open(pid)
        else:
            os.kill(pid, 0)

    @property
    def gone(self) -> bool:
        """Whether it has ended."""
        return self.wait(0.0)

    def wait(self, timeout_s: float) -> bool:
        """Until it has ended, or the time is up; whether it has."""
        if self._fd is not None:
            poll = select.poll()
            poll.register(self._fd, select.POLLIN)
            return bool(poll.poll(1e3 * timeout_s))
        end = time.monotonic() + timeout_s
        while True:
            try:
                os.kill(self.pid, 0)
            except ProcessLookupError:
                return True
            if time.monotonic() >= end:
                return False
            time.sleep(_LOOK_S)

    def signal(self, number: int) -> None:
        """Send it a signal; one that has ended does not mind."""
        with suppress(ProcessLookupError):
            if self._fd is not None:
                signal.pidfd_send_signal(self._fd, number)
            else:
                os.kill(self.pid, number)

    def close(self) -> None:
        """Let go of it."""
        if self._fd is not None:
            os.close(self._fd)
            self._fd = None
