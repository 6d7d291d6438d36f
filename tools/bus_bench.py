"""How fast the bus is on this machine: its messages, seven processes in lockstep over it, and recording them."""

from __future__ import annotations

import os
import time
from collections.abc import Iterator
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import Any

from surefoot.bus.topics import CYCLE_HZ
from surefoot.components.lockstep import Lockstep
from surefoot.config.deployment import Deployment, Run, load_deployment
from surefoot.tools.bus_latency import bus_latency
from surefoot.tools.commands.call import deployment_file
from surefoot.tools.journal_cost import Tape, recorder_cost, tapes, write_journals
from surefoot.tools.picture import Picture
from surefoot.tools.supervisor import Supervisor

_WALK_S = 3.5  # stands up, plans a stride and begins it: every topic has been published by then
_SEND_S = 10.0
_LIVE_FROM_S, _LIVE_S = 2.0, 3.0

_RECORDER_SHARE = 0.10  # of a core that a recorder may take at full rate


def bus_bench() -> dict[str, Any]:
    """Measure the bus; takes about a minute.

    Returns:
        `latency` as of `bus_latency`; `recording` as of `recorder_cost`, with `journals`: the share of a core
        that each process's takes; `cycle_hz`: cycles for each wall second of seven processes on simulated time.
    """
    deployment = Deployment(run=Run(vision=True))
    with TemporaryDirectory(prefix="surefoot-bench-") as folder:
        stack, recorded = walk(deployment, _WALK_S)
        return {
            "latency": bus_latency(namespace("latency"), messages(recorded), _SEND_S),
            "recording": recording(stack, deployment, recorded, Path(folder) / "bench.mcap"),
            "cycle_hz": live_cycle_hz(_LIVE_FROM_S, _LIVE_S, Path(folder)),
        }


def rows(found: dict[str, Any], real_time_factor: float) -> Iterator[tuple[str, str, str]]:
    """What was found, as rows `what, asked, got`.

    Args:
        found: as `bus_bench` returns it.
        real_time_factor: of a stack in one process, to be told beside the others.
    """
    recording, latency = found["recording"], found["latency"]
    share = recording["recorder"]
    missed = "" if share <= _RECORDER_SHARE else "  missed"
    lost = "".join(f"  lost: {each}" for each in recording["lost"])
    yield "recorder [share of a core]", f"<= {_RECORDER_SHARE:g}", f"{share:6.3f}{missed}{lost}"
    yield "  journals in the processes, in all", "", f"{sum(recording['journals'].values()):6.3f}"
    yield "  handing them over", "", f"{recording['handing_over']:6.3f}"
    yield "  file [MB/s]", "", f"{recording['mb_per_s']:6.2f}"
    yield "lockstep over the bus [cycles/s]", "", f"{found['cycle_hz']:6.0f}"
    yield "  in one process", "", f"{CYCLE_HZ * real_time_factor:6.0f}"
    yield "CPU of a message [us]", "", "".join(f"{name} {us:.0f}  " for name, us in latency["cpu_us"].items())
    yield "latency p50, p99 [ms]; encode, decode [us]", "", ""
    for key, of in latency["topics"].items():
        lost = f"  {of['lost']} of {of['sent']} lost" if of["lost"] else ""
        yield (
            f"  {key}, {of['bytes'] / 1e3:.1f} kB, {of['hz']:g} Hz",
            "direct" if of["direct"] else "",
            f"{of['p50_ms']:6.2f} {of['p99_ms']:6.2f} {of['encode_us']:6.0f} {of['decode_us']:6.0f}{lost}",
        )


def namespace(of: str) -> str:
    """Of a bus that no run has."""
    return f"bench-{os.getpid()}-{of}"


def walk(deployment: Deployment, seconds: float) -> tuple[Lockstep, list[Tape]]:
    """A stack in one process after so many seconds of its time, and what its journals were told."""
    stack = Lockstep(deployment)
    recorded = tapes(stack)
    stack.command(deployment.run.command)
    stack.run(seconds)
    return stack, recorded


def messages(recorded: list[Tape]) -> dict[str, list[bytes]]:
    """The bytes of all messages, by topic."""
    return {key: payloads for tape in recorded for key, payloads in tape.messages().items()}


def recording(stack: Lockstep, deployment: Deployment, recorded: list[Tape], path: Path) -> dict[str, Any]:
    """What journals and recorder take of a core at full rate."""
    written = write_journals(stack, recorded)
    return recorder_cost(namespace("recorder"), deployment, written, path) | {"journals": written.cpu}


def live_cycle_hz(from_s: float, seconds: float, folder: Path) -> float:
    """Cycles of the robot for each wall second, of the processes of `surefoot run flat` on simulated time.

    Args:
        from_s: the run's time at which measuring begins; before it the processes warm up.
        seconds: of the run's time that is measured.
        folder: for logs.

    Raises:
        RuntimeError: the run ended before that.
    """
    overrides = [f"run.namespace={namespace('live')}", f"run.log_dir={folder / 'log'}"]
    config = deployment_file("flat")
    watch = _Watch(from_s, seconds)
    reason = Supervisor(config, overrides, load_deployment(config, overrides)).run(watch)
    if not watch.cycle_hz:
        raise RuntimeError(f"bench: the run on flat ground has ended: {reason}")
    return watch.cycle_hz


class _Watch:
    """Tells a supervisor when to end, and how fast the run's time has passed until then.

    Attributes:
        cycle_hz: cycles for each wall second; 0 before the end.
    """

    def __init__(self, from_s: float, seconds: float):
        self.cycle_hz = 0.0
        self._from_s, self._seconds = from_s, seconds
        self._begun: tuple[float, float] | None = None  # on the wall's clock and on the run's [s]

    def __call__(self, picture: Picture) -> str:
        now = time.monotonic()
        if self._begun is None:
            if picture.t >= self._from_s:
                self._begun = now, picture.t
            return ""
        wall, t = self._begun
        if picture.t < t + self._seconds:
            return ""
        self.cycle_hz = CYCLE_HZ * (picture.t - t) / (now - wall)
        return "measured"
