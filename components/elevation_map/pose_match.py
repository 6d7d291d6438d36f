"""Which estimate belongs to which image: the one of the same time, or none."""

from __future__ import annotations

from collections import deque

from surefoot.bus.codec import decode, encode
from surefoot.bus.messages import DepthFrame, StateEstimate

_KEPT = 128
"""Estimates: those of a quarter of a second."""

_PATIENCE_S = 0.2
"""An image whose estimate has not come by then is dropped [s]."""


class PoseMatch:
    """The latest estimates, and images that wait for theirs: an image comes before the estimate of its time."""

    def __init__(self) -> None:
        self._estimates: deque[StateEstimate] = deque(maxlen=_KEPT)
        self._waiting: list[DepthFrame] = []

    def clear(self) -> None:
        """Forget estimates and images: they are of a frame that is gone."""
        self._estimates.clear()
        self._waiting.clear()

    def add_estimate(self, estimate: StateEstimate) -> None:
        """The next estimate in time."""
        self._estimates.append(estimate)

    def add_frame(self, frame: DepthFrame) -> None:
        """An image that can be used."""
        self._waiting.append(frame)

    def snapshot(self) -> list[bytes]:
        """The images that wait; those to come find the estimates of their times among those to come."""
        return [encode(frame) for frame in self._waiting]

    def restore(self, waiting: list[bytes]) -> None:
        """Take over what `snapshot` gave."""
        self._waiting = [decode(DepthFrame, payload) for payload in waiting]

    def matched(self, t: float) -> tuple[list[tuple[DepthFrame, StateEstimate]], str]:
        """Images with the estimate of their time, oldest first, and why the last other one was dropped, if any."""
        by_time = {estimate.t: estimate for estimate in self._estimates}
        newest = self._estimates[-1].t if self._estimates else float("-inf")
        pairs, waiting, dropped = [], [], ""
        for frame in self._waiting:
            if frame.t in by_time:
                pairs.append((frame, by_time[frame.t]))
            elif newest > frame.t:
                dropped = f"the image of {frame.t:.3f} s has no state/estimate of its time"
            elif abs(t - frame.t) > _PATIENCE_S:
                dropped = f"the image of {frame.t:.3f} s found no state/estimate within {_PATIENCE_S} s"
            else:
                waiting.append(frame)
        self._waiting = waiting
        return pairs, dropped
