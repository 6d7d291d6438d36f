"""`surefoot run`: the supervisor with a status on the terminal and a summary at the end."""

from __future__ import annotations

import time
from collections import Counter
from pathlib import Path

from rich.console import Console
from rich.live import Live

from surefoot.config.deployment import Deployment
from surefoot.config.robot import LEGS
from surefoot.tools.status_screen import screen
from surefoot.tools.supervisor import Picture, Supervisor

_LINES = ("collapse", "late_collapse", "accepted", "rejected", "stopped", "refused")


def live_run(config: Path, overrides: list[str], deployment: Deployment, seconds: float, plain: bool) -> int:
    """Run a deployment until its goal is reached, a process fails or the user ends it; returns the exit code."""
    console = Console()
    supervisor = Supervisor(config, overrides, deployment)

    def until(picture: Picture) -> str:
        reference = picture.reference
        if reference is None:
            return ""
        if reference.finished:
            return "goal reached"
        if reference.state == "DAMP" and "fallen" in reference.reason:
            return f"the robot fell: {reference.reason}"
        return "time is up" if seconds and reference.t >= seconds else ""

    log = Path(deployment.run.log_dir)
    console.print(f"{config}, {deployment.run.clock} clock, logs in {log}/; Ctrl-C ends the run")
    try:
        if plain or not console.is_terminal:
            reason = supervisor.run(until, _Lines(console))
        else:
            with Live(screen(supervisor.picture), console=console, refresh_per_second=5) as live:
                reason = supervisor.run(until, lambda picture: live.update(screen(picture)))
    except KeyboardInterrupt:
        reason = "ended by the user"
    _summary(console, supervisor.picture, reason, log)
    return 0 if reason in ("goal reached", "time is up", "ended by the user", "stopped by command") else 1


class _Lines:
    """The status as lines, for a terminal that is none."""

    def __init__(self, console: Console):
        self._console, self._told, self._t = console, 0, -10.0

    def __call__(self, picture: Picture) -> None:
        events = list(picture.events)
        for event in events[self._told :]:
            if event.kind in _LINES:
                leg = LEGS[event.leg] if event.leg >= 0 else ""
                self._console.print(f"{event.t:7.1f} s  {leg} {event.kind}: {event.reason}")
        self._told = len(events)
        reference = picture.reference
        if reference is not None and reference.t - self._t >= 10.0:
            self._t = reference.t
            factor = reference.t / max(time.monotonic() - picture.began, 1e-3)
            self._console.print(f"{reference.t:7.1f} s  {reference.state}, real-time factor {factor:.2f}")


def _summary(console: Console, picture: Picture, reason: str, log: Path) -> None:
    counts = Counter(event.kind for event in picture.events)
    reference, estimate = picture.reference, picture.estimate
    console.print(f"\n{reason}")
    if reference is not None and estimate is not None:
        passed = time.monotonic() - picture.began
        console.print(
            f"{reference.t:.1f} s of the run's time in {passed:.0f} s, {estimate.p_WB[0]:.2f} m forward, "
            f"{counts['accepted']} footholds accepted, {counts['collapse']} collapses, "
            f"{counts['rejected']} candidates out of reach"
        )
    console.print(f"process logs: {log}/")
