"""What the control chain asks of its machine: to come before ordinary programs, and onlookers after all."""

from __future__ import annotations

import ctypes
import os
import resource
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

_THREADS = Path("/proc/self/task")
_TOPOLOGY = "/sys/devices/system/cpu"
_MCL_CURRENT, _MCL_FUTURE, _MCL_ONFAULT = 1, 2, 4  # of mlockall(2)
_REMEDY = "`surefoot service install`, or `USER - rtprio 80` in /etc/security/limits.d/ and a new login"


def claim(priority: int, core: int) -> bool:
    """Give every thread of this process a real-time priority and one core, and keep its memory in place.

    Threads that are made later have both too. To be called after all that is slow: as long as such a process
    computes, its core is closed to ordinary programs. On one core it is not moved a thousand times a second from
    the other's cache to its own, and leaves the core the time that Linux keeps for ordinary programs: once they
    have waited for nearly a second, 50 ms of it come before any real-time priority. Memory is kept only where its
    amount is unlimited: beyond a limit the process could get no more.

    Args:
        priority: of SCHED_FIFO, 1 to 99; the higher interrupts the lower.
        core: of those that this process may use, counted from 0; where there are fewer, the last. Two threads of
            one core (hyper-threading) count as two, the second ones after all first ones.

    Returns:
        Whether the machine permits it; `refusal` says why not.
    """
    if not _permitted(priority):
        return False
    cores = _cores(os.sched_getaffinity(0))
    for thread in _THREADS.iterdir():
        try:
            os.sched_setscheduler(int(thread.name), os.SCHED_FIFO, os.sched_param(priority))
            os.sched_setaffinity(int(thread.name), {cores[min(core, len(cores) - 1)]})
        except ProcessLookupError:
            continue  # it has ended meanwhile
    if resource.RLIM_INFINITY in resource.getrlimit(resource.RLIMIT_MEMLOCK):
        ctypes.CDLL(None).mlockall(_MCL_CURRENT | _MCL_FUTURE | _MCL_ONFAULT)
    return True


@contextmanager
def preferred(priority: int) -> Iterator[bool]:
    """Inside it the calling thread has this real-time priority, if the machine permits it: whether it does."""
    if not hasattr(os, "sched_setscheduler"):
        yield False
        return
    before, parameters = os.sched_getscheduler(0), os.sched_getparam(0)
    try:
        os.sched_setscheduler(0, os.SCHED_FIFO, os.sched_param(priority))
    except PermissionError:
        yield False
        return
    try:
        yield True
    finally:
        os.sched_setscheduler(0, before, parameters)


def give_way() -> None:
    """Let the calling thread, and those that it makes, compute only when no other wants to.

    Niceness is not enough: even the nicest thread may finish its slice of some milliseconds before one that wakes
    up, and that is more than a cycle. For good: an ordinary user cannot take it back. Only Linux has this.
    """
    if hasattr(os, "SCHED_IDLE"):
        os.sched_setscheduler(0, os.SCHED_IDLE, os.sched_param(0))


def refusal(priority: int) -> str:
    """Why this machine refuses a real-time priority, with the remedy; empty where it does not."""
    if _permitted(priority):
        return ""
    return (
        f"no real-time priority {priority} (run.realtime_priority): other programs may hold up the control chain, "
        f"and the robot is damped when commands are late; {_REMEDY}"
    )


def _cores(allowed: set[int]) -> list[int]:
    """In an order in which neighbours share no core as long as there is another one."""

    def place(thread: int) -> tuple[int, int]:
        return sum(other < thread for other in _threads_of_its_core(thread) & allowed), thread

    return sorted(allowed, key=place)


def _threads_of_its_core(thread: int) -> set[int]:
    try:
        spans = Path(f"{_TOPOLOGY}/cpu{thread}/topology/thread_siblings_list").read_text().strip().split(",")
    except OSError:
        return {thread}
    ends = [(int(span.split("-")[0]), int(span.split("-")[-1])) for span in spans]
    return {other for first, last in ends for other in range(first, last + 1)}


def _permitted(priority: int) -> bool:
    with preferred(priority) as permitted:
        return permitted
