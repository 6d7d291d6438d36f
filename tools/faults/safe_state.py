"""What the robot does when a process is missing on the monotonic clock, and within which time: declared here."""

from __future__ import annotations

from surefoot.bus.topics import CYCLE_HZ, TOPICS
from surefoot.config.deployment import Deployment

WORDS = {
    "io": "no cycle before it runs again; the first one damps",
    "estimator": "without estimates no command: the gate damps",
    "wbc": "the gate damps",
    "mpc": "wbc holds the base, lowers it, damps",
    "fsm": "wbc puts a lifted foot down, holds the base, lowers it, damps",
    "trajopt": "the robot stands and waits for the plan",
    "elevation_map": "the robot stands and waits for its footholds",
}
"""Of each process; one that ends by itself ends the run too, once the robot has sat down where it can."""


def damped_within_s(deployment: Deployment, process: str) -> float | None:
    """Longest time from the last sign of a process until every joint is damped [s]; None: it need not be."""
    wbc = deployment.wbc
    if process in ("estimator", "wbc"):
        return deployment.hw.command_timeout_s + 1.0 / CYCLE_HZ
    if process in ("mpc", "fsm"):
        key = "mpc/policy" if process == "mpc" else "fsm/reference"
        return TOPICS[key].stale_after_s + wbc.hold_s + wbc.lower_m / wbc.lower_speed
    return 1.0 / CYCLE_HZ if process == "io" else None
