"""Checks of this machine: may it run in real time, does its timer keep 500 Hz, is there room for logs."""

from __future__ import annotations

import os
import re
import resource
import shutil
import sys
import time
from collections.abc import Sequence
from contextlib import nullcontext, suppress
from dataclasses import dataclass
from importlib import metadata
from math import inf
from pathlib import Path

import numpy as np

from surefoot.bus.topics import CYCLE_HZ, PROCESSES
from surefoot.components.real_time import preferred
from surefoot.components.registry import component_class
from surefoot.config.deployment import Deployment, Run
from surefoot.config.doctor import Doctor
from surefoot.hw.aliengo.deadlines import Deadlines
from surefoot.tools.doctor.check import Finding, Level, does_not_apply, graded, well

MEMORY_LOCK_BYTES = 1 << 30
"""What may be locked at the least: all processes of a run together."""

_CAP_SYS_NICE = 1 << 23
_GOVERNORS = Path("/sys/devices/system/cpu")
_RESOLUTION_S = 1e-5


@dataclass(frozen=True)
class Machine:
    """What this machine is and may.

    Attributes:
        rt_priority: highest real-time priority this user may ask for; 0: none.
        may_nice: the process has CAP_SYS_NICE.
        memory_lock: bytes it may lock; infinite without a limit.
        resolution_s: of the monotonic clock.
        lateness_s: of each cycle of a 500 Hz timer, as measured.
        cores, load: that may be used, and the mean number of programs that ran in the last minute.
        governors: of the cores' clocks; empty: not told.
        free_bytes: where logs go.
        versions: of each library: its name, the version there is or "", the one that is wanted.
        broken: why processes that are to run here cannot be loaded, in words.
    """

    rt_priority: int
    may_nice: bool
    memory_lock: float
    resolution_s: float
    lateness_s: np.ndarray
    cores: int
    load: float
    governors: frozenset[str]
    free_bytes: int
    versions: tuple[tuple[str, str, str], ...]
    broken: tuple[str, ...] = ()


def check_machine(machine: Machine, run: Run, limits: Doctor) -> list[Finding]:
    """All findings of this group."""
    if run.clock == "simulated":
        waits = "run.clock = 'simulated': time waits"
        real_time = [does_not_apply(check, waits) for check in ("real-time priority", "memory lock", "timer")]
    else:
        real_time = [check_priority(machine), check_memory_lock(machine), check_timer(machine, limits)]
    return [
        *real_time,
        check_clock(machine),
        check_cores(machine, run),
        check_load(machine, limits),
        check_governor(machine),
        check_disk(machine, run, limits),
        check_versions(machine.versions, machine.broken),
    ]


def check_priority(machine: Machine) -> Finding:
    """Whether processes may ask to be preferred."""
    check, expected = "real-time priority", "RLIMIT_RTPRIO above 0, or CAP_SYS_NICE"
    if machine.may_nice:
        return well(check, "CAP_SYS_NICE", expected)
    if machine.rt_priority > 0:
        return well(check, f"up to {machine.rt_priority}", expected)
    remedy = "`surefoot service install`, or `USER - rtprio 80` in /etc/security/limits.d/ and a new login"
    return Finding(check, Level.WARN, "not permitted", expected, remedy)


def check_memory_lock(machine: Machine) -> Finding:
    """Whether memory can be kept from being swapped out."""
    check, expected = "memory lock", f"{MEMORY_LOCK_BYTES / 1e9:.1f} GB or more"
    found = "unlimited" if machine.memory_lock == inf else f"{machine.memory_lock / 1e6:.0f} MB"
    if machine.memory_lock >= MEMORY_LOCK_BYTES:
        return well(check, found, expected)
    remedy = "`surefoot service install`, or `USER - memlock unlimited` in /etc/security/limits.d/ and a new login"
    return Finding(check, Level.WARN, found, expected, remedy)


def check_clock(machine: Machine) -> Finding:
    """The monotonic clock's resolution."""
    found, expected = f"{1e9 * machine.resolution_s:.0f} ns", f"within {1e6 * _RESOLUTION_S:.0f} us"
    remedy = "the kernel has no high-resolution timers: use one with CONFIG_HIGH_RES_TIMERS"
    return graded("clock", machine.resolution_s, (_RESOLUTION_S, _RESOLUTION_S), (found, expected, remedy))


def check_timer(machine: Machine, limits: Doctor) -> Finding:
    """How late a 500 Hz timer is."""
    p99 = 1e3 * float(np.quantile(machine.lateness_s, 0.99))
    words = (
        f"{CYCLE_HZ:.0f} Hz late by {p99:.2f} ms (p99), at most {1e3 * machine.lateness_s.max():.2f} ms",
        f"p99 within {limits.jitter_warn_ms:g} ms",
        "end other programs, governor performance, real-time priority, cores of its own (CPUAffinity)",
    )
    return graded("timer", p99, (limits.jitter_warn_ms, limits.jitter_fail_ms), words)


def check_cores(machine: Machine, run: Run) -> Finding:
    """As many as the processes want."""
    found, expected = f"{machine.cores}", f"{run.cores_min} (run.cores_min)"
    if machine.cores >= run.cores_min:
        return well("cores", found, expected)
    remedy = "the MPC takes its light profile (docs/hardware.md); give it a machine with more"
    return Finding("cores", Level.WARN, found, expected, remedy)


def check_load(machine: Machine, limits: Doctor) -> Finding:
    """What else runs."""
    share = machine.load / machine.cores
    words = (
        f"{machine.load:.2f} on {machine.cores} cores",
        f"within {limits.load_warn:g} a core",
        "end what runs",
    )
    return graded("load", share, (limits.load_warn, inf), words)


def check_governor(machine: Machine) -> Finding:
    """Whether the cores keep their clock."""
    check, expected, found = "CPU governor", "performance", ", ".join(sorted(machine.governors))
    if not found:
        return does_not_apply(check, "this kernel does not tell")
    if machine.governors == {expected}:
        return well(check, found, expected)
    remedy = "`cpupower frequency-set -g performance`: a core that slept wakes late"
    return Finding(check, Level.WARN, found, expected, remedy)


def check_disk(machine: Machine, run: Run, limits: Doctor) -> Finding:
    """Room for logs and a recording."""
    free = machine.free_bytes / 1e9
    words = (
        f"{free:.1f} GB free for {run.log_dir}/",
        f"{limits.free_warn_gb:g} GB",
        "make room, or set run.log_dir: a recording takes 5 MB a second",
    )
    return graded("disk", -free, (-limits.free_warn_gb, -limits.free_fail_gb), words)


def check_versions(versions: Sequence[tuple[str, str, str]], broken: Sequence[str] = ()) -> Finding:
    """Libraries are those that the project was tested with, and can be loaded."""
    check, python = "libraries", f"Python {sys.version.split()[0]}"
    if broken:
        remedy = "a lib....so is a package of the system, such as libgomp1 (Debian), else `pip install -e .`"
        return Finding(check, Level.FAIL, "; ".join(broken), "every process can be loaded", remedy)
    if not versions:
        return Finding(check, Level.WARN, python, "surefoot installed", "install it: `pip install -e .`")
    odd = [f"{name} {there or 'missing'}, not {wanted}" for name, there, wanted in versions if there != wanted]
    if not odd:
        return well(check, f"{python}, {', '.join(f'{name} {there}' for name, there, _ in versions)}")
    missing = any(not there for _, there, _ in versions)
    remedy = "`pip install -e .` in the project's folder"
    return Finding(check, Level.FAIL if missing else Level.WARN, "; ".join(odd), "those of pyproject.toml", remedy)


def look_at_machine(deployment: Deployment) -> Machine:
    """Of this machine as it is now; watches its timer for `doctor.watch_s`, at the priority that io asks for."""
    run = deployment.run
    priority = run.realtime_priority + PROCESSES["io"].urgency if run.clock == "monotonic" else 0
    soft, hard = resource.getrlimit(resource.RLIMIT_MEMLOCK)
    return Machine(
        rt_priority=max(resource.getrlimit(resource.RLIMIT_RTPRIO)),
        may_nice=_has_capability(_CAP_SYS_NICE),
        memory_lock=inf if resource.RLIM_INFINITY in (soft, hard) else max(soft, hard),
        resolution_s=time.get_clock_info("monotonic").resolution,
        lateness_s=timer_lateness(deployment.doctor.watch_s, priority),
        cores=len(os.sched_getaffinity(0)),
        load=os.getloadavg()[0],
        governors=frozenset(
            path.read_text().strip() for path in _GOVERNORS.glob("cpu[0-9]*/cpufreq/scaling_governor")
        ),
        free_bytes=shutil.disk_usage(_existing(Path(run.log_dir))).free,
        versions=_versions(),
        broken=_broken(deployment.network.components_here),
    )


def timer_lateness(seconds: float, priority: int = 0) -> np.ndarray:
    """How late this thread woke in each cycle of a 500 Hz timer [s]; with real-time priority where it may."""
    late: list[float] = []
    with preferred(priority) if priority else nullcontext():
        begin = time.monotonic()
        deadlines = Deadlines(1.0 / CYCLE_HZ, begin)
        while (now := time.monotonic()) < begin + seconds:
            deadline, _ = deadlines.following(now)
            time.sleep(max(deadline - now, 0.0))
            late.append(time.monotonic() - deadline)
    return np.array(late)


def _has_capability(bit: int) -> bool:
    with suppress(OSError):
        match = re.search(r"^CapEff:\s*([0-9a-f]+)$", Path("/proc/self/status").read_text(), re.MULTILINE)
        return match is not None and bool(int(match[1], 16) & bit)
    return False


def _existing(folder: Path) -> Path:
    """The folder, or the nearest above it that is there."""
    folder = folder.resolve()
    return next(each for each in (folder, *folder.parents) if each.exists())


def _versions() -> tuple[tuple[str, str, str], ...]:
    """Of what `pyproject.toml` pins for a run; empty where the project is not installed."""
    found = []
    with suppress(metadata.PackageNotFoundError):
        for line in metadata.requires("surefoot") or ():
            pinned = re.fullmatch(r"([\w.-]+)==([\w.]+)", line.strip())
            if pinned:
                found.append((pinned[1], _version(pinned[1]), pinned[2]))
    return tuple(found)


def _broken(processes: Sequence[str]) -> tuple[str, ...]:
    """One of several reasons that are alike is enough."""
    found: dict[str, str] = {}
    for name in processes:
        try:
            component_class(name)
        except ImportError as error:
            found.setdefault(str(error), name)
    return tuple(f"{name}: {why}" for why, name in found.items())


def _version(name: str) -> str:
    try:
        return metadata.version(name)
    except metadata.PackageNotFoundError:
        return ""
