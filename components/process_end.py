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
            signal.signal(number, lambda *_: self._event.set())
        Thread(target=self._watch, args=(parent or os.getppid(),), daemon=True).start()

    @property
    def due(self) -> bool:
        """True once the process has to end."""
        return self._event.is_set()

    def _watch(self, parent: int) -> None:
        while os.getppid() == parent:
            time.sleep(_LOOK_S)
        self._event.set()
        time.sleep(_GRACE_S)  # to end in order; a step that hangs must not keep the process alive
        os._exit(1)
