"""When a process of the run has to end: it is told to, or whoever started it is gone."""

from __future__ import annotations

import os
import signal
import time
from threading import Event, Thread

_LOOK_S = 0.2
_GRACE_S = 3.0


class ProcessEnd:
    """Watches signals and the parent; no process outlives its supervisor, even one killed without warning."""

    def __init__(self, parent: int = 0):
        """`parent`: the process that must live on; 0 the one that started this one."""
        self._event = Event()
        for number in (signal.SIGTERM, signal.SIGINT):
            signal.signal(number, self._on_signal)
        Thread(target=self._watch, args=(parent or os.getppid(),), daemon=True).start()

    @property
    def due(self) -> bool:
        """True once the process has to end."""
        return self._event.is_set()

    def _on_signal(self, number: int, frame: object) -> None:
        """End in order; a second Ctrl-C breaks off a step that hangs."""
        if number == signal.SIGINT and self._event.is_set():
            raise KeyboardInterrupt
        self._event.set()

    def _watch(self, parent: int) -> None:
        while os.getppid() == parent:
            time.sleep(_LOOK_S)
        self._event.set()
        time.sleep(_GRACE_S)  # to end in order; a step that hangs must not keep the process alive
        os._exit(1)
