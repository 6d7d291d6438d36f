"""The signals that end a run in order: Ctrl-C, `kill`, and a terminal that is closed."""

from __future__ import annotations

import signal
from collections.abc import Iterator
from contextlib import contextmanager

ENDS_RUN = (signal.SIGINT, signal.SIGTERM, signal.SIGHUP)


def heed() -> None:
    """From now on each of them raises KeyboardInterrupt, but for those that are ignored, as `nohup` has it."""
    for number in ENDS_RUN:
        if signal.getsignal(number) is not signal.SIG_IGN:
            signal.signal(number, signal.default_int_handler)


@contextmanager
def deaf() -> Iterator[None]:
    """Inside it they are ignored."""
    before = {number: signal.signal(number, signal.SIG_IGN) for number in ENDS_RUN}
    try:
        yield
    finally:
        for number, handler in before.items():
            signal.signal(number, handler)
