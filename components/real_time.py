"""What the control chain asks of its machine on the monotonic clock: to come before ordinary programs."""

from __future__ import annotations

import ctypes
import os
import resource
from pathlib import Path

_THREADS = Path("/proc/self/task")
_MCL_CURRENT, _MCL_FUTURE, _MCL_ONFAULT = 1, 2, 4  # of mlockall(2)
_REMEDY = "`surefoot service install`, or `USER - rtprio 80` in /etc/security/limits.d/ and a new login"


def claim(priority: int) -> bool:
    """Give every thread of this process a real-time priority, and keep its memory from being swapped out.

    Threads that are made later have it too. To be called after all that is slow: as long as such a process
    computes, its core is closed to ordinary programs. Memory is kept only where its amount is unlimited: beyond a
    limit the process could get no more.

    Args:
        priority: of SCHED_FIFO, 1 to 99; the higher interrupts the lower.

    Returns:
        Whether the machine permits it; `refusal` says why not.
    """
    if not _permitted(priority):
        return False
    for thread in _THREADS.iterdir():
        try:
            os.sched_setscheduler(int(thread.name), os.SCHED_FIFO, os.sched_param(priority))
        except ProcessLookupError:
            continue  # it has ended meanwhile
    if resource.RLIM_INFINITY in resource.getrlimit(resource.RLIMIT_MEMLOCK):
        ctypes.CDLL(None).mlockall(_MCL_CURRENT | _MCL_FUTURE | _MCL_ONFAULT)
    return True


def refusal(priority: int) -> str:
    """Why this machine refuses a real-time priority, with the remedy; empty where it does not."""
    if _permitted(priority):
        return ""
    return (
        f"no real-time priority {priority} (run.realtime_priority): other programs may hold up the control chain, "
        f"and the robot is damped when commands are late; {_REMEDY}"
    )


def _permitted(priority: int) -> bool:
    """Found out on the calling thread, which is left as it was."""
    if not hasattr(os, "sched_setscheduler"):
        return False
    before, parameters = os.sched_getscheduler(0), os.sched_getparam(0)
    try:
        os.sched_setscheduler(0, os.SCHED_FIFO, os.sched_param(priority))
    except PermissionError:
        return False
    os.sched_setscheduler(0, before, parameters)
    return True
