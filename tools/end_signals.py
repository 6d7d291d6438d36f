"""The signals that end a run in order: Ctrl-C, `kill`, and a terminal that is closed."""

from __future__ import annotations

import signal
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from types import FrameType

ENDS_RUN = (signal.SIGINT, signal.SIGTERM, signal.SIGHUP)


def heed(ends: Callable[[], bool] = lambda: False) -> None:
    """From now on each of them raises KeyboardInterrupt, but for those that are ignored, as `nohup` has it.

    Args:
        ends: asked first, in the middle of anything; none is raised where it says that the run ends by itself.
    """

    def ask(number: int, frame: FrameType | None) -> None:
        if not ends():
            raise KeyboardInterrupt

    for number in ENDS_RUN:
        if signal.getsignal(number) is not signal.SIG_IGN:
            signal.signal(number, ask)


@contextmanager
def deaf() -> Iterator[None]:
    """Inside it they are ignored."""
    before = {number: signal.signal(number, signal.SIG_IGN) for number in ENDS_RUN}
    try:
        yield
    finally:
        for number, handler in before.items():
            signal.signal(number, handler)
