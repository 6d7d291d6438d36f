"""Simulated time: which component is released when, and when its output becomes visible.

An event heap over integer nanoseconds. A release at t steps the component on everything visible at t; its
output becomes visible at t + budget (logical execution time), whatever the step really took. At equal times
outputs become visible before components are released, and components are released in the order of the
process table. The same scheduler drives components in this process and, over the bus, in others: an
`Executor` is all it knows of them. Runs of one configuration and seed are therefore equal byte for byte.
"""

from __future__ import annotations

import heapq
from collections.abc import Callable, Mapping
from typing import Protocol

from surefoot.bus.topics import PROCESSES, Process

NS = 1_000_000_000

_VISIBLE, _RELEASE = 0, 1


class Executor(Protocol):
    """Steps one component somewhere."""

    def release(self, t_ns: int, visible: dict[str, int]) -> None:
        """Begin the step of a release.

        Args:
            t_ns: release time.
            visible: for each topic, how many messages in all are visible by now.
        """

    def collect(self) -> dict[str, int]:
        """Wait for that step; how many messages it published on each topic."""


class Scheduler:
    """The master of simulated time.

    Attributes:
        t_ns: present simulated time.
        visible: for each topic, how many messages have become visible so far.
    """

    def __init__(self, executors: Mapping[str, Executor], table: Mapping[str, Process] = PROCESSES):
        """`table` says when each process is released; of it, those that have an executor take part."""
        self._executors = executors
        self._processes = {name: process for name, process in table.items() if name in executors}
        self._order = {name: index for index, name in enumerate(PROCESSES)}
        self._triggers: dict[str, list[Process]] = {}
        for process in self._processes.values():
            if process.trigger:
                self._triggers.setdefault(process.trigger, []).append(process)
        self._heap: list[tuple[int, int, int, str]] = []
        self._busy: set[str] = set()
        self.t_ns = 0
        self.visible: dict[str, int] = {}
        for process in self._processes.values():
            if process.rate_hz:
                self._push(0, _RELEASE, process.name)

    def inject(self, key: str, count: int = 1) -> None:
        """Make messages from outside the scheduled processes visible now (an operator's command)."""
        self._show(key, count)

    def run_until(self, t_ns: int, stop: Callable[[], bool] = lambda: False) -> None:
        """Advance to `t_ns`, or until `stop()` holds between two instants."""
        while self._heap and self._heap[0][0] <= t_ns:
            if self._heap[0][0] > self.t_ns and stop():
                return
            self.t_ns, kind, _, name = heapq.heappop(self._heap)
            if kind == _VISIBLE:
                self._finish(name)
            else:
                self._release(name)
        self.t_ns = max(self.t_ns, t_ns)

    def _release(self, name: str) -> None:
        process = self._processes[name]
        if process.rate_hz:
            self._push(self.t_ns + round(NS / process.rate_hz), _RELEASE, name)
        if name in self._busy:
            # A trigger that comes within the budget is served when the step before it is done.
            self._push(self.t_ns + round(process.budget_s * NS), _RELEASE, name)
            return
        self._busy.add(name)
        self._executors[name].release(self.t_ns, self.visible)
        if process.budget_s == 0.0:
            self._finish(name)
        else:
            self._push(self.t_ns + round(process.budget_s * NS), _VISIBLE, name)

    def _finish(self, name: str) -> None:
        self._busy.discard(name)
        for key, count in self._executors[name].collect().items():
            self._show(key, count)

    def _show(self, key: str, count: int) -> None:
        for _ in range(count):
            seen = self.visible[key] = self.visible.get(key, 0) + 1
            for process in self._triggers.get(key, ()):
                if seen % process.every == 0:
                    self._push(self.t_ns, _RELEASE, process.name)

    def _push(self, t_ns: int, kind: int, name: str) -> None:
        heapq.heappush(self._heap, (t_ns, kind, self._order[name], name))
